#include "core/hdf5_file.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <type_traits>
#include <utility>

#include "core/error.hpp"

namespace repose {
namespace {

/// Owns one HDF5 identifier of any kind.
class Id {
 public:
  Id() = default;
  explicit Id(hid_t value) : value_(value) {}
  Id(Id&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  Id& operator=(Id&& other) noexcept {
    std::swap(value_, other.value_);
    return *this;
  }
  ~Id() { reset(); }
  void reset() {
    if (value_ >= 0) H5Idec_ref(value_);
    value_ = -1;
  }
  bool valid() const { return value_ >= 0; }
  operator hid_t() const { return value_; }

 private:
  hid_t value_ = -1;
};

/// HDF5 keeps its state in the process and is thread-safe only if built so: one thread at a time.
std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// One use of the library. It prints its error stack unless told otherwise; the setting is put back.
class Session {
 public:
  Session() : lock_(library_mutex()) {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Session() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  std::lock_guard<std::mutex> lock_;
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

template <class T>
hid_t memory_type() {
  if constexpr (std::is_same_v<T, float>) return H5T_NATIVE_FLOAT;
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, std::uint64_t>) return H5T_NATIVE_UINT64;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
}

template <class T>
hid_t file_type() {
  if constexpr (std::is_same_v<T, float>) return H5T_IEEE_F32LE;
  if constexpr (std::is_same_v<T, double>) return H5T_IEEE_F64LE;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_STD_I32LE;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_STD_I64LE;
  if constexpr (std::is_same_v<T, std::uint64_t>) return H5T_STD_U64LE;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_STD_U8LE;
}

void demand(bool good, const std::string& path) {
  if (!good) throw Error(path, "cannot be put into an HDF5 file", "check that there is memory left", Error::Kind::simulation);
}

Id text_type(std::size_t length) {
  Id type(H5Tcopy(H5T_C_S1));
  H5Tset_size(type, std::max<std::size_t>(length, 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

/// HDF5 takes files in memory for one and the same if their names are equal; an owner that lives names its own.
std::string name_in_memory(const void* owner) { return fmt::format("in memory at {}", owner); }

constexpr std::size_t memory_increment = std::size_t{1} << 20;
constexpr hsize_t chunk_values = hsize_t{1} << 16;

/// Access through memory, in the oldest format that has checksums in its metadata.
Id access_in_memory() {
  Id access(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_fapl_core(access, memory_increment, false);
  H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18);
  return access;
}

/// Takes over the memory of a file when HDF5 closes it. (The bytes that H5Fget_file_image returns cannot be opened: it
/// clears the flags of the superblock, but leaves the checksum.)
struct Image {
  std::size_t size = 0;  ///< set just before the file is closed
  std::string bytes;
};

void* image_allocate(std::size_t size, H5FD_file_image_op_t, void*) { return std::malloc(size); }
void* image_reallocate(void* memory, std::size_t size, H5FD_file_image_op_t, void*) { return std::realloc(memory, size); }
void* image_copy(void* to, const void* from, std::size_t size, H5FD_file_image_op_t, void*) {
  return std::memcpy(to, from, size);
}
herr_t image_release(void* memory, H5FD_file_image_op_t reason, void* user) {
  Image& image = *static_cast<Image*>(user);
  if (reason == H5FD_FILE_IMAGE_OP_FILE_CLOSE) image.bytes.assign(static_cast<const char*>(memory), image.size);
  std::free(memory);
  return 0;
}
void* share_user(void* user) { return user; }
herr_t keep_user(void*) { return 0; }

}  // namespace

struct Hdf5Writer::Impl {
  Packing packing;
  Image image;  // outlives the file
  Id file;

  /// Groups that HDF5 makes by itself on the way to a dataset would carry the time of day.
  void make_groups(const std::string& path) const {
    Id creation(H5Pcreate(H5P_GROUP_CREATE));
    H5Pset_obj_track_times(creation, false);
    for (std::size_t slash = path.find('/', 1); slash != std::string::npos; slash = path.find('/', slash + 1)) {
      const std::string group = path.substr(0, slash);
      if (H5Lexists(file, group.c_str(), H5P_DEFAULT) > 0) continue;
      demand(Id(H5Gcreate2(file, group.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT)).valid(), group);
    }
  }

  Id layout(hsize_t rows, hsize_t columns) const {
    Id creation(H5Pcreate(H5P_DATASET_CREATE));
    H5Pset_obj_track_times(creation, false);
    if (packing == Packing::compressed && rows > 0) {
      std::array<hsize_t, 2> chunk{std::min(rows, std::max<hsize_t>(1, chunk_values / columns)), columns};
      H5Pset_chunk(creation, columns == 1 ? 1 : 2, chunk.data());
      H5Pset_shuffle(creation);
      H5Pset_deflate(creation, 1);
      H5Pset_fletcher32(creation);
    }
    return creation;
  }
};

Hdf5Writer::Hdf5Writer(Packing packing) : impl_(std::make_unique<Impl>()) {
  const Session session;
  impl_->packing = packing;
  Id creation(H5Pcreate(H5P_FILE_CREATE));
  H5Pset_obj_track_times(creation, false);
  const Id access = access_in_memory();
  H5FD_file_image_callbacks_t callbacks{image_allocate, image_copy, image_reallocate, image_release,
                                        share_user,     keep_user,  &impl_->image};
  H5Pset_file_image_callbacks(access, &callbacks);
  impl_->file = Id(H5Fcreate(name_in_memory(impl_.get()).c_str(), H5F_ACC_TRUNC, creation, access));
  demand(impl_->file.valid(), "HDF5");
}

Hdf5Writer::~Hdf5Writer() {
  const Session session;
  impl_.reset();
}

template <class T>
void Hdf5Writer::write(const std::string& path, std::span<const T> values, std::size_t columns) {
  const Session session;
  demand(columns > 0 && values.size() % columns == 0, path);
  impl_->make_groups(path);
  const std::array<hsize_t, 2> extent{values.size() / columns, columns};
  const Id space(H5Screate_simple(columns == 1 ? 1 : 2, extent.data(), nullptr));
  const Id creation = impl_->layout(extent[0], extent[1]);
  const Id set(H5Dcreate2(impl_->file, path.c_str(), file_type<T>(), space, H5P_DEFAULT, creation, H5P_DEFAULT));
  demand(set.valid(), path);
  if (values.empty()) return;
  demand(H5Dwrite(set, memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0, path);
}

void Hdf5Writer::write_text(const std::string& path, const std::string& text) {
  const Session session;
  impl_->make_groups(path);
  const Id type = text_type(text.size());
  const Id space(H5Screate(H5S_SCALAR));
  Id creation(H5Pcreate(H5P_DATASET_CREATE));
  H5Pset_obj_track_times(creation, false);
  const Id set(H5Dcreate2(impl_->file, path.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT));
  demand(set.valid(), path);
  demand(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) >= 0, path);
}

void Hdf5Writer::link(const std::string& path, const std::string& file) {
  const Session session;
  impl_->make_groups(path);
  demand(H5Lcreate_external(file.c_str(), "/", impl_->file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT) >= 0, path);
}

std::string Hdf5Writer::bytes() {
  const Session session;
  demand(H5Fflush(impl_->file, H5F_SCOPE_GLOBAL) >= 0, "HDF5");
  const ssize_t size = H5Fget_file_image(impl_->file, nullptr, 0);
  demand(size > 0, "HDF5");
  impl_->image.size = static_cast<std::size_t>(size);
  impl_->file.reset();
  demand(impl_->image.bytes.size() == static_cast<std::size_t>(size), "HDF5");
  return std::move(impl_->image.bytes);
}

struct Hdf5Reader::Impl {
  std::string name, remedy;
  Id file;

  [[noreturn]] void fail(const std::string& path, const std::string& problem) const {
    throw Error(path.empty() ? name : name + ":" + path, problem, remedy);
  }
  Id open(const std::string& path) const {
    Id set(H5Dopen2(file, path.c_str(), H5P_DEFAULT));
    if (!set.valid()) fail(path, "this dataset is missing or cannot be opened");
    return set;
  }
  /// `count` strings of a dataset, or of one field of its records.
  std::vector<std::string> strings(const std::string& path, hid_t set, const std::string& field, hid_t stored,
                                   std::size_t count) const {
    std::vector<std::string> texts(count);
    if (count == 0) return texts;
    const Id memory = of_field(field, stored);
    if (H5Tis_variable_str(stored) > 0) {
      std::vector<char*> pointers(count, nullptr);
      if (H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()) < 0) fail(path, "is damaged");
      for (std::size_t i = 0; i < count; ++i)
        if (pointers[i] != nullptr) texts[i] = pointers[i];
      const Id space(H5Dget_space(set));
      H5Dvlen_reclaim(memory, space, H5P_DEFAULT, pointers.data());
      return texts;
    }
    const std::size_t length = H5Tget_size(stored);
    std::string all(length * count, '\0');
    if (H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) < 0) fail(path, "is damaged");
    for (std::size_t i = 0; i < count; ++i) {
      texts[i] = all.substr(i * length, length);
      texts[i].resize(std::min(texts[i].find('\0'), texts[i].size()));
    }
    return texts;
  }
  /// The type in memory of a whole value, or of a record that holds nothing but `field`.
  static Id of_field(const std::string& field, hid_t value) {
    if (field.empty()) return Id(H5Tcopy(value));
    Id record(H5Tcreate(H5T_COMPOUND, H5Tget_size(value)));
    H5Tinsert(record, field.c_str(), 0, value);
    return record;
  }
};

Hdf5Reader::Hdf5Reader(const std::filesystem::path& file, std::string remedy) : impl_(std::make_unique<Impl>()) {
  const Session session;
  impl_->name = file.string();
  impl_->remedy = std::move(remedy);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) impl_->fail("", "there is no such file");
  impl_->file = Id(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  if (!impl_->file.valid()) impl_->fail("", "is not an HDF5 file, or is truncated");
}

Hdf5Reader::Hdf5Reader(const std::string& bytes, std::string name, std::string remedy) : impl_(std::make_unique<Impl>()) {
  const Session session;
  impl_->name = std::move(name);
  impl_->remedy = std::move(remedy);
  const Id access = access_in_memory();
  // HDF5 copies the image and only reads it, but takes it as not constant.
  H5Pset_file_image(access, const_cast<char*>(bytes.data()), bytes.size());
  impl_->file = Id(H5Fopen(name_in_memory(impl_.get()).c_str(), H5F_ACC_RDONLY, access));
  if (!impl_->file.valid()) impl_->fail("", "is not an HDF5 file, or is truncated");
}

Hdf5Reader::~Hdf5Reader() {
  const Session session;
  impl_.reset();
}

bool Hdf5Reader::has(const std::string& path) const {
  const Session session;
  return Id(H5Oopen(impl_->file, path.c_str(), H5P_DEFAULT)).valid();
}

template <class T>
std::vector<T> Hdf5Reader::read(const std::string& path, std::size_t columns, std::size_t rows) const {
  const Session session;
  const Id set = impl_->open(path);
  const Id space(H5Dget_space(set));
  std::array<hsize_t, 2> extent{0, 1};
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank != (columns == 1 ? 1 : 2)) impl_->fail(path, "has an unexpected number of dimensions");
  H5Sget_simple_extent_dims(space, extent.data(), nullptr);
  if (extent[1] != columns || (rows != any && extent[0] != rows)) {
    impl_->fail(path, "has the extent " + std::to_string(extent[0]) + " x " + std::to_string(extent[1]) + ", expected " +
                          (rows == any ? "n" : std::to_string(rows)) + " x " + std::to_string(columns));
  }
  // A damaged header may claim an extent that no memory holds.
  if (extent[0] > hsize_t{1} << 40) impl_->fail(path, "is damaged");
  std::vector<T> values(extent[0] * extent[1]);
  if (!values.empty() && H5Dread(set, memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    impl_->fail(path, "is damaged or of another type");
  return values;
}

std::string Hdf5Reader::read_text(const std::string& path) const {
  const Session session;
  const Id set = impl_->open(path);
  const Id stored(H5Dget_type(set));
  const Id space(H5Dget_space(set));
  if (H5Tget_class(stored) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) impl_->fail(path, "is not a text");
  return impl_->strings(path, set, "", stored, 1).front();
}

Hdf5Reader::Kind Hdf5Reader::kind(const std::string& path) const {
  const Session session;
  const Id object(H5Oopen(impl_->file, path.c_str(), H5P_DEFAULT));
  if (!object.valid()) return Kind::nothing;
  if (H5Iget_type(object) == H5I_GROUP) return Kind::group;
  if (H5Iget_type(object) != H5I_DATASET) return Kind::other;
  const Id stored(H5Dget_type(object));
  const Id space(H5Dget_space(object));
  const int rank = H5Sget_simple_extent_ndims(space);
  const H5T_class_t type = H5Tget_class(stored);
  if (type == H5T_STRING && H5Sget_simple_extent_npoints(space) == 1) return Kind::text;
  if (type == H5T_COMPOUND && rank == 1) return Kind::table;
  const bool plain = type == H5T_STRING || type == H5T_FLOAT || type == H5T_INTEGER;
  return plain && rank == 1 ? Kind::list : Kind::other;
}

std::vector<std::string> Hdf5Reader::fields(const std::string& path) const {
  const Session session;
  const Id set = impl_->open(path);
  const Id stored(H5Dget_type(set));
  if (H5Tget_class(stored) != H5T_COMPOUND) impl_->fail(path, "is not a table");
  std::vector<std::string> names;
  for (int i = 0; i < H5Tget_nmembers(stored); ++i) {
    char* name = H5Tget_member_name(stored, static_cast<unsigned>(i));
    names.emplace_back(name);
    H5free_memory(name);
  }
  return names;
}

Hdf5Reader::Column Hdf5Reader::column(const std::string& path, const std::string& field) const {
  const Session session;
  const Id set = impl_->open(path);
  const Id space(H5Dget_space(set));
  if (H5Sget_simple_extent_ndims(space) > 1) impl_->fail(path, "has an unexpected number of dimensions");
  Id value(H5Dget_type(set));
  if (!field.empty()) {
    const int index = H5Tget_class(value) == H5T_COMPOUND ? H5Tget_member_index(value, field.c_str()) : -1;
    if (index < 0) impl_->fail(path, "has no field `" + field + "`");
    value = Id(H5Tget_member_type(value, static_cast<unsigned>(index)));
  }
  const std::string place = field.empty() ? path : path + "." + field;
  const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
  // A damaged header may claim an extent that no memory holds.
  if (count > std::size_t{1} << 32) impl_->fail(place, "is damaged");
  const H5T_class_t type = H5Tget_class(value);
  if (type == H5T_STRING) return impl_->strings(place, set, field, value, count);
  if (type != H5T_FLOAT && type != H5T_INTEGER) impl_->fail(place, "holds neither numbers nor strings");
  std::vector<double> numbers(count);
  const Id memory = Impl::of_field(field, H5T_NATIVE_DOUBLE);
  if (count > 0 && H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()) < 0)
    impl_->fail(place, "is damaged or of another type");
  return numbers;
}

std::vector<std::string> Hdf5Reader::members(const std::string& path) const {
  const Session session;
  const Id group(H5Gopen2(impl_->file, path.c_str(), H5P_DEFAULT));
  if (!group.valid()) impl_->fail(path, "this group is missing");
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* into) -> herr_t {
    static_cast<std::vector<std::string>*>(into)->emplace_back(name);
    return 0;
  };
  if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names) < 0) impl_->fail(path, "is damaged");
  return names;
}

template void Hdf5Writer::write(const std::string&, std::span<const float>, std::size_t);
template void Hdf5Writer::write(const std::string&, std::span<const double>, std::size_t);
template void Hdf5Writer::write(const std::string&, std::span<const std::int32_t>, std::size_t);
template void Hdf5Writer::write(const std::string&, std::span<const std::int64_t>, std::size_t);
template void Hdf5Writer::write(const std::string&, std::span<const std::uint64_t>, std::size_t);
template void Hdf5Writer::write(const std::string&, std::span<const std::uint8_t>, std::size_t);
template std::vector<float> Hdf5Reader::read(const std::string&, std::size_t, std::size_t) const;
template std::vector<double> Hdf5Reader::read(const std::string&, std::size_t, std::size_t) const;
template std::vector<std::int32_t> Hdf5Reader::read(const std::string&, std::size_t, std::size_t) const;
template std::vector<std::int64_t> Hdf5Reader::read(const std::string&, std::size_t, std::size_t) const;
template std::vector<std::uint64_t> Hdf5Reader::read(const std::string&, std::size_t, std::size_t) const;
template std::vector<std::uint8_t> Hdf5Reader::read(const std::string&, std::size_t, std::size_t) const;

}  // namespace repose
