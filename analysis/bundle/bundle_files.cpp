#include "analysis/bundle/bundle_files.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>
#include <optional>
#include <vector>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/hdf5_file.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;

const std::string recording_yaml = "recording.yaml";

class Folder : public BundleFiles {
 public:
  Folder(fs::path file, const fs::path& root)
      : file_(std::move(file)), folder_(file_.has_parent_path() ? file_.parent_path() : fs::path(".")),
        root_(root.empty() ? folder_ : root) {}

  std::string recording_name() const override { return file_.string(); }
  std::string recording() const override { return read_bytes(file_); }
  fs::path scene_name(const std::string& file) const override { return folder_ / file; }
  bool has_scene(const std::string& file) const override {
    std::error_code ignored;
    return fs::is_regular_file(scene_name(file), ignored);
  }
  std::string scene(const std::string& file) const override { return read_bytes(scene_name(file)); }
  CsvTable table(const std::string& file) const override { return read_csv(root_ / file); }

 private:
  fs::path file_, folder_, root_;
};

/// A column as a CSV file would hold it.
std::vector<std::string> as_fields(const Hdf5Reader::Column& column) {
  if (const auto* texts = std::get_if<std::vector<std::string>>(&column)) return *texts;
  std::vector<std::string> fields;
  for (const double value : std::get<std::vector<double>>(column))
    fields.push_back(std::isnan(value) ? "" : fmt::format("{}", value));  // the shortest that reads back to the same bits
  return fields;
}

class Hdf5Bundle : public BundleFiles {
 public:
  Hdf5Bundle(fs::path file, fs::path root)
      : file_(std::move(file)), root_(std::move(root)),
        reader_(file_, "an HDF5 bundle has the tree of a bundle's folder: recording.yaml, the scene, and the data") {}

  std::string recording_name() const override { return name_of(recording_yaml); }
  std::string recording() const override { return reader_.read_text("/" + recording_yaml); }
  /// In the folder of the HDF5 file, so that the meshes that a scene names lie beside that.
  fs::path scene_name(const std::string& file) const override { return name_of(file); }
  bool has_scene(const std::string& file) const override {
    return reader_.kind("/" + file) == Hdf5Reader::Kind::text;
  }
  std::string scene(const std::string& file) const override { return reader_.read_text("/" + file); }

  CsvTable table(const std::string& file) const override {
    if (!root_.empty()) return read_csv(root_ / file);
    const std::string path = "/" + file;
    if (reader_.kind(path) != Hdf5Reader::Kind::nothing) return table_at(path);
    constexpr std::string_view suffix = ".csv";
    if (path.ends_with(suffix)) {
      const std::string bare = path.substr(0, path.size() - suffix.size());
      if (reader_.kind(bare) != Hdf5Reader::Kind::nothing) return table_at(bare);
    }
    throw Error(name_of(file), "no such data", "check `file:` in recording.yaml, and --root if the data lie elsewhere");
  }

 private:
  std::string name_of(const std::string& file) const { return file_.string() + ":" + file; }

  CsvTable table_at(const std::string& path) const {
    const std::string name = file_.string() + ":" + path;
    switch (reader_.kind(path)) {
      case Hdf5Reader::Kind::text:
        return parse_csv(reader_.read_text(path), name);
      case Hdf5Reader::Kind::table: {
        std::vector<std::vector<std::string>> columns;
        const std::vector<std::string> names = reader_.fields(path);
        for (const std::string& field : names) columns.push_back(as_fields(reader_.column(path, field)));
        return of_columns(name, names, columns);
      }
      case Hdf5Reader::Kind::group:
        return group_at(path, name);
      default:
        throw Error(name, "neither a CSV text, nor a table, nor a group of columns",
                    "store the records as a compound type, or each column as a list of its own in a group");
    }
  }

  CsvTable group_at(const std::string& path, const std::string& name) const {
    const std::vector<std::string> names = reader_.members(path);
    std::vector<std::vector<std::string>> columns;
    std::vector<std::size_t> single;  // one string for all rows
    std::optional<std::size_t> rows;
    for (const std::string& member : names) {
      const std::string place = path + "/" + member;
      const Hdf5Reader::Kind kind = reader_.kind(place);
      if (kind == Hdf5Reader::Kind::text) {
        single.push_back(columns.size());
        columns.push_back({reader_.read_text(place)});
        continue;
      }
      if (kind != Hdf5Reader::Kind::list)
        throw Error(file_.string() + ":" + place, "is not a column", "a column is a one-dimensional list of numbers or strings");
      columns.push_back(as_fields(reader_.column(place)));
      if (rows && *rows != columns.back().size())
        throw Error(name, fmt::format("column `{}` has {} rows, another {}", member, columns.back().size(), *rows),
                    "give all columns the same length; NaN where nothing was observed");
      rows = columns.back().size();
    }
    for (const std::size_t i : single) columns[i].resize(rows.value_or(1), columns[i].front());
    return of_columns(name, names, columns);
  }

  static CsvTable of_columns(const std::string& name, const std::vector<std::string>& names,
                             const std::vector<std::vector<std::string>>& columns) {
    if (names.empty()) throw Error(name, "empty", "give it columns, such as time, x, y, z");
    CsvTable table;
    table.name = name;
    table.column = names;
    for (std::size_t i = 0; i < columns.front().size(); ++i) {
      table.rows.push_back({static_cast<int>(i) + 1, {}});
      for (const std::vector<std::string>& column : columns) table.rows.back().field.push_back(column[i]);
    }
    return table;
  }

  fs::path file_, root_;
  Hdf5Reader reader_;
};

/// The first eight bytes of the format (HDF5 File Format Specification, "Superblock").
bool is_hdf5(const fs::path& file) {
  constexpr std::array<char, 8> signature{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  std::array<char, 8> first{};
  std::ifstream(file, std::ios::binary).read(first.data(), first.size());
  return first == signature;
}

}  // namespace

std::unique_ptr<BundleFiles> open_bundle_files(const fs::path& path, const fs::path& root) {
  std::error_code ignored;
  if (!fs::exists(path, ignored))
    throw Error(path.string(), "no such bundle", "name a folder that holds recording.yaml, or an HDF5 file of that tree");
  if (!root.empty() && !fs::is_directory(root, ignored))
    throw Error("--root " + root.string(), "no such folder", "name the folder of the CSV files");
  if (!fs::is_directory(path, ignored)) {
    if (is_hdf5(path)) return std::make_unique<Hdf5Bundle>(path, root);
    return std::make_unique<Folder>(path, root);
  }
  const fs::path file = path / recording_yaml;
  if (!fs::is_regular_file(file, ignored))
    throw Error(path.string(), "holds no recording.yaml", "a bundle is a folder with recording.yaml and CSV files");
  return std::make_unique<Folder>(file, root);
}

}  // namespace repose
