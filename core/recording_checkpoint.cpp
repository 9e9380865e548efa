#include "core/recording_checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/hdf5_file.hpp"
#include "core/recording_state.hpp"

namespace repose {
namespace {

constexpr std::size_t header_size = 512;
constexpr const char* header_format = "repose checkpoint 1, {} bytes, checksum {:016x}\n";
constexpr const char* remedy = "the file is damaged; the one before it may be intact";

std::string content_of(const Checkpoint& c) {
  Hdf5Writer file(Hdf5Writer::Packing::plain);
  file.write_text("/run/backend", c.run.backend);
  file.write("/run/identity", std::vector<std::uint64_t>{c.run.model, c.run.scene, c.run.seed});
  file.write("/run/step", std::vector<std::int64_t>{c.frame.step});
  file.write("/run/wall_s", std::vector<double>{c.wall_s});
  file.write("/run/ended", std::vector<std::uint8_t>{c.ended});
  file.write("/frame_times", c.frame_times);
  write_steps(file, "/steps", c.steps);
  write_snapshot<double>(file, "/state", c.frame.state);
  for (const auto& [name, values] : c.frame.numbers) file.write("/numbers/" + name, values);
  for (const auto& [name, values] : c.frame.integers) file.write("/integers/" + name, values);
  return file.bytes();
}

std::string header_of(const std::string& content) {
  std::string header = fmt::format(header_format, content.size(), checksum(content));
  header.resize(header_size);
  return header;
}

/// -1 if the name is not that of a checkpoint.
long long step_of(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  long long step = -1;
  int length = 0;
  if (std::sscanf(name.c_str(), "step-%lld.h5%n", &step, &length) != 1) return -1;
  return length == static_cast<int>(name.size()) ? step : -1;
}

}  // namespace

std::vector<std::filesystem::path> find_checkpoints(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    if (step_of(entry.path()) >= 0) files.push_back(entry.path());
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return step_of(a) > step_of(b); });
  return files;
}

void write_checkpoint(const std::filesystem::path& folder, const Checkpoint& checkpoint) {
  const std::string content = content_of(checkpoint);
  write_durably(folder / fmt::format("step-{:012d}.h5", checkpoint.frame.step), header_of(content), content);
  const auto files = find_checkpoints(folder);
  std::error_code ignored;
  for (std::size_t i = 2; i < files.size(); ++i) std::filesystem::remove(files[i], ignored);
}

Checkpoint read_checkpoint(const std::filesystem::path& file) {
  const std::string bytes = read_bytes(file);
  const std::string content = bytes.substr(std::min(bytes.size(), header_size));
  if (bytes.rfind(fmt::format(header_format, content.size(), checksum(content)), 0) != 0)
    throw Error(file.string(), "this checkpoint is truncated or damaged: its checksum does not hold", remedy);

  const Hdf5Reader in(content, file.string(), remedy);
  Checkpoint c;
  c.run.backend = in.read_text("/run/backend");
  const auto identity = in.read<std::uint64_t>("/run/identity", 1, 3);
  c.run.model = identity[0];
  c.run.scene = identity[1];
  c.run.seed = identity[2];
  c.frame.step = in.read<std::int64_t>("/run/step", 1, 1).front();
  c.wall_s = in.read<double>("/run/wall_s", 1, 1).front();
  c.ended = in.read<std::uint8_t>("/run/ended", 1, 1).front() != 0;
  c.frame_times = in.read<double>("/frame_times");
  c.steps = read_steps(in, "/steps");
  c.frame.state = read_snapshot<double>(in, "/state", in.read<double>("/state/position", 3).size() / 3);
  if (in.has("/numbers"))
    for (const std::string& name : in.members("/numbers")) c.frame.numbers[name] = in.read<double>("/numbers/" + name);
  if (in.has("/integers"))
    for (const std::string& name : in.members("/integers"))
      c.frame.integers[name] = in.read<std::int64_t>("/integers/" + name);
  return c;
}

}  // namespace repose
