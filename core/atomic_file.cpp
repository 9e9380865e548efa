#include "core/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "core/error.hpp"
#include "core/recording.hpp"

namespace repose {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what, int code) {
  const std::string remedy = code == ENOSPC || code == EDQUOT
                                 ? "make room on the disk, then continue with --resume"
                                 : "choose a folder that can be written with --out";
  throw Error(file.string(), what + ": " + std::strerror(code), remedy, Error::Kind::simulation);
}

/// Closes the file descriptor on every way out.
struct Descriptor {
  int value = -1;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};

}  // namespace

void write_durably(const std::filesystem::path& file, std::string_view bytes, std::string_view more) {
  std::filesystem::path aside = file;
  aside += ".partial";
  {
    Descriptor out{::open(aside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)};
    if (out.value < 0) fail(aside, "cannot be written", errno);
    for (std::string_view rest : {bytes, more})
      while (!rest.empty()) {
        const ssize_t n = ::write(out.value, rest.data(), rest.size());
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) {
          const int code = errno;
          ::unlink(aside.c_str());
          fail(file, "cannot be written", code);
        }
        rest.remove_prefix(static_cast<std::size_t>(n));
      }
    if (::fsync(out.value) != 0) fail(file, "cannot be made durable", errno);
  }
  if (::rename(aside.c_str(), file.c_str()) != 0) fail(file, "cannot be renamed into place", errno);
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  // Some file systems refuse fsync on a folder; the rename is then as durable as they make it.
  Descriptor place{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (place.value >= 0) ::fsync(place.value);
}

void write_atomically(const std::filesystem::path& file, const std::string& text) { write_durably(file, text); }

std::string read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string bytes;
  if (in) bytes.assign(std::istreambuf_iterator<char>(in), {});
  if (!in) throw Error(file.string(), "cannot be read: " + std::string(std::strerror(errno)), "check that it exists");
  return bytes;
}

std::uint64_t checksum(std::string_view bytes) {
  static_assert(std::endian::native == std::endian::little, "words are read as they lie in memory");
  std::uint64_t h = bytes.size();
  while (!bytes.empty()) {
    const std::size_t n = bytes.size() < 8 ? bytes.size() : 8;
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data(), n);
    h = std::rotl(h ^ word, 29) * 0x9E3779B97F4A7C15u;
    bytes.remove_prefix(n);
  }
  return h ^ (h >> 32);
}

}  // namespace repose
