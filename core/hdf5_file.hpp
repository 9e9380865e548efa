#pragma once
/// HDF5 files, built in memory and read back. The same calls give the same bytes: no times, a fixed format version.
///
/// A file is made whole before a byte of it reaches the disk, so a full disk or a kill can spoil only the file aside (see
/// atomic_file.hpp), and HDF5 itself never sees an I/O error. Metadata and data both carry checksums (superblock 2,
/// Fletcher-32 on each chunk). Arrays are [rows x columns], row-major; text is UTF-8. Any number of
/// files may be open at once, on any threads (each object on one at a time); the calls take turns.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace repose {

class Hdf5Writer {
 public:
  enum class Packing {
    plain,       ///< contiguous: for what is read once, soon (checkpoints)
    compressed,  ///< gzip 1 + shuffle, with a checksum per chunk
  };

  explicit Hdf5Writer(Packing packing);
  ~Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  /// Writes a dataset; groups on the way are made. `columns` = 1 gives a one-dimensional dataset; it divides the size.
  /// T: float, double, std::int32_t, std::int64_t, std::uint64_t, std::uint8_t.
  template <class T>
  void write(const std::string& path, std::span<const T> values, std::size_t columns = 1);
  template <class T>
  void write(const std::string& path, const std::vector<T>& values, std::size_t columns = 1) {
    write(path, std::span<const T>(values), columns);
  }
  /// A scalar string dataset.
  void write_text(const std::string& path, const std::string& text);
  /// A link to the root of another file, relative to the folder of this one.
  void link(const std::string& path, const std::string& file);

  /// Closes the file and returns it. Nothing can be written afterwards.
  std::string bytes();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads an HDF5 file. Every failure is an Error that names the file and the dataset.
class Hdf5Reader {
 public:
  /// Opens a file on disk; `remedy` is the last line of every message.
  explicit Hdf5Reader(const std::filesystem::path& file, std::string remedy = "");
  /// Opens a file that is already in memory; `name` stands for it in messages.
  Hdf5Reader(const std::string& bytes, std::string name, std::string remedy);
  ~Hdf5Reader();
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;

  bool has(const std::string& path) const;
  /// All values of a dataset, converted to T. With `rows` or `columns` given, another extent is an Error.
  template <class T>
  std::vector<T> read(const std::string& path, std::size_t columns = 1, std::size_t rows = any) const;
  /// A scalar string, of fixed or variable length.
  std::string read_text(const std::string& path) const;
  /// What stands under a path.
  enum class Kind {
    nothing,
    group,
    text,   ///< one string
    table,  ///< a list of records with named fields
    list,   ///< numbers or strings, one-dimensional
    other,
  };
  Kind kind(const std::string& path) const;
  /// Names of the fields of a table, in their order.
  std::vector<std::string> fields(const std::string& path) const;
  /// A list (`field` empty) or one field of a table: numbers as double, or strings.
  using Column = std::variant<std::vector<double>, std::vector<std::string>>;
  Column column(const std::string& path, const std::string& field = "") const;
  /// Names of the members of a group, sorted.
  std::vector<std::string> members(const std::string& path) const;

  static constexpr std::size_t any = ~std::size_t{0};

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace repose
