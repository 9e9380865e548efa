#include "analysis/diagnosis/simulation_store.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include "core/atomic_file.hpp"

namespace repose::diagnosis {
namespace {

// magic, checksum of the key, checksum of the rest; then hash, length, numbers of each entry.
constexpr std::uint64_t magic = 0x3153424f53504552;
constexpr std::size_t header = 3 * sizeof(std::uint64_t), entry_header = 2 * sizeof(std::uint64_t);

void put(std::string& bytes, std::uint64_t word) { bytes.append(reinterpret_cast<const char*>(&word), sizeof word); }

std::uint64_t word_at(const std::string& bytes, std::size_t at) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

std::size_t bytes_of(const Eigen::VectorXd& v) { return entry_header + static_cast<std::size_t>(v.size()) * sizeof(double); }

}  // namespace

SimulationStore::SimulationStore(std::filesystem::path file, std::string key, std::size_t limit)
    : file_(std::move(file)), key_(std::move(key)), limit_(limit) {
  if (std::error_code none; std::filesystem::exists(file_, none) && !read()) entries_.clear(), bytes_ = 0;
}

bool SimulationStore::read() {
  const std::string bytes = read_bytes(file_);
  if (bytes.size() < header || word_at(bytes, 0) != magic || word_at(bytes, 8) != checksum(key_) ||
      word_at(bytes, 16) != checksum(std::string_view(bytes).substr(header)))
    return false;
  for (std::size_t at = header; at < bytes.size();) {
    if (bytes.size() - at < entry_header) return false;
    const std::uint64_t hash = word_at(bytes, at), length = word_at(bytes, at + 8);
    at += entry_header;
    if (length > (bytes.size() - at) / sizeof(double)) return false;
    Entry entry{Eigen::VectorXd(static_cast<Eigen::Index>(length)), false};
    // An empty result has no memory to copy to.
    if (length > 0) std::memcpy(entry.result.data(), bytes.data() + at, length * sizeof(double));
    at += length * sizeof(double);
    bytes_ += bytes_of(entry.result);
    entries_.emplace(hash, std::move(entry));
  }
  return true;
}

std::optional<Eigen::VectorXd> SimulationStore::find(std::uint64_t hash) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(hash);
  if (found == entries_.end()) return std::nullopt;
  found->second.used = true;
  return found->second.result;
}

void SimulationStore::add(std::uint64_t hash, const Eigen::VectorXd& result) {
  const std::lock_guard lock(mutex_);
  if (bytes_ + bytes_of(result) > 2 * limit_) return;
  if (entries_.emplace(hash, Entry{result, true}).second) bytes_ += bytes_of(result);
}

void SimulationStore::save() const {
  if (file_.empty()) return;
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<std::uint64_t, const Entry*>> order;
  for (const auto& [hash, entry] : entries_) order.emplace_back(hash, &entry);
  std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return a.second->used != b.second->used ? a.second->used : a.first < b.first;
  });
  std::string body;
  for (const auto& [hash, entry] : order) {
    if (body.size() + bytes_of(entry->result) > limit_) break;
    put(body, hash);
    put(body, static_cast<std::uint64_t>(entry->result.size()));
    if (entry->result.size() > 0)
      body.append(reinterpret_cast<const char*>(entry->result.data()),
                  static_cast<std::size_t>(entry->result.size()) * sizeof(double));
  }
  std::string bytes;
  put(bytes, magic);
  put(bytes, checksum(key_));
  put(bytes, checksum(body));
  write_durably(file_, bytes + body);
}

}  // namespace repose::diagnosis
