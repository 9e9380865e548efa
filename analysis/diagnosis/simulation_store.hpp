#pragma once
/// What simulations gave, by the hash of all that it depends on: in memory, and in a file for the next diagnosis of the same data.
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

#include <Eigen/Core>

namespace repose::diagnosis {

class SimulationStore {
 public:
  /// In memory alone.
  SimulationStore() = default;
  /// With what `file` holds, if that was written under the same `key` (backend and build) and is not damaged; else empty.
  SimulationStore(std::filesystem::path file, std::string key, std::size_t limit = std::size_t{256} << 20);

  /// An empty vector: that simulation failed.
  std::optional<Eigen::VectorXd> find(std::uint64_t hash);
  void add(std::uint64_t hash, const Eigen::VectorXd& result);

  /// Writes the file durably: first what this process has used, then older results while they fit the limit.
  void save() const;

  std::size_t size() const { return entries_.size(); }

 private:
  struct Entry {
    Eigen::VectorXd result;
    bool used = true;
  };
  bool read();

  std::filesystem::path file_;
  std::string key_;
  std::size_t limit_ = std::size_t{256} << 20, bytes_ = 0;
  std::unordered_map<std::uint64_t, Entry> entries_;
  mutable std::mutex mutex_;
};

}  // namespace repose::diagnosis
