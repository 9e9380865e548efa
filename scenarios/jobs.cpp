#include "scenarios/jobs.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "core/atomic_file.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

using Clock = std::chrono::steady_clock;

std::filesystem::path result_file(const std::filesystem::path& folder, const std::string& key) {
  return folder / "jobs" / (key + ".json");
}

// What an earlier call left; nullopt if there is nothing of use.
std::optional<JobResult> kept(const std::filesystem::path& folder, const Job& job) {
  const std::filesystem::path file = result_file(folder, job.key);
  if (!std::filesystem::is_regular_file(file)) return std::nullopt;
  const nlohmann::json content = nlohmann::json::parse(read_bytes(file), nullptr, false);
  if (content.is_discarded() || !content.is_object() || !content.contains("observables") || content.value("key", "") != job.key)
    return std::nullopt;
  return JobResult{content["observables"], ""};
}

void keep(const std::filesystem::path& folder, const Job& job, const JobResult& result) {
  const nlohmann::json content = {{"key", job.key}, {"seed", job.seed}, {"observables", result.observables}};
  write_durably(result_file(folder, job.key), content.dump(2) + "\n");
}

// The jobs still to do, handed out in order; equal keys once.
class Board {
 public:
  Board(const std::vector<Job>& jobs, std::vector<std::optional<JobResult>>& results) : jobs_(jobs), results_(results) {
    for (std::size_t i = 0; i < jobs.size(); ++i)
      if (!results[i]) twins_[jobs[i].key].push_back(i);
    for (std::size_t i = 0; i < jobs.size(); ++i)
      if (!results[i] && twins_[jobs[i].key].front() == i) open_.push_back(i);
    running_ = 0;
  }

  std::optional<std::size_t> take() {
    const std::lock_guard lock(mutex_);
    if (stopped_ || next_ == open_.size()) return std::nullopt;
    ++running_;
    return open_[next_++];
  }
  void give(std::size_t job, std::optional<JobResult> result) {
    const std::lock_guard lock(mutex_);
    --running_;
    if (result)
      for (std::size_t twin : twins_[jobs_[job].key]) results_[twin] = result;
    if (result) ++finished_;
    changed_.notify_all();
  }
  void stop(std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    if (!error_) error_ = error;
    changed_.notify_all();
  }

  /// Waits a moment; false when all is over.
  bool wait() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::milliseconds(200));
    return running_ > 0 || (!stopped_ && next_ < open_.size());
  }
  std::exception_ptr error() const { return error_; }
  bool stopped() {
    const std::lock_guard lock(mutex_);
    return stopped_;
  }
  std::size_t to_do() const { return open_.size(); }
  std::size_t finished() {
    const std::lock_guard lock(mutex_);
    return finished_;
  }
  template <class Read>
  void read(Read look) {
    const std::lock_guard lock(mutex_);
    look(results_);
  }

 private:
  const std::vector<Job>& jobs_;
  std::vector<std::optional<JobResult>>& results_;
  std::map<std::string, std::vector<std::size_t>> twins_;
  std::vector<std::size_t> open_;
  std::size_t next_ = 0, running_ = 0, finished_ = 0;
  bool stopped_ = false;
  std::exception_ptr error_;
  std::mutex mutex_;
  std::condition_variable changed_;
};

JobsProgress progress_of(Board& board, std::size_t reused, Clock::time_point start) {
  JobsProgress p;
  board.read([&](const std::vector<std::optional<JobResult>>& results) {
    p.total = results.size();
    for (const auto& r : results) {
      p.done += r.has_value();
      p.failed += r && !r->failure.empty();
    }
  });
  p.reused = reused;
  p.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  const double finished = static_cast<double>(board.finished()), left = static_cast<double>(board.to_do()) - finished;
  if (finished > 0) p.remaining_s = p.wall_s / finished * left;
  return p;
}

}  // namespace

std::string job_key(const std::string& scene_text, std::uint64_t seed, const std::string& backend, const std::string& version) {
  return fmt::format("{:016x}", checksum(fmt::format("{}\n{}\n{}\n{}", scene_text, seed, backend, version)));
}

JobsReport run_jobs(const std::vector<Job>& jobs, const std::filesystem::path& folder, int workers, const SimulateJob& simulate,
                    const JobsHooks& hooks) {
  if (workers < 1) throw Error("--threads", "must be at least 1", "");
  std::error_code error;
  std::filesystem::create_directories(folder / "jobs", error);
  if (error) throw Error(folder.string(), "cannot be made: " + error.message(), "choose another folder with --out");
  JobsReport report;
  report.results.resize(jobs.size());
  std::size_t reused = 0;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    report.results[i] = kept(folder, jobs[i]);
    reused += report.results[i].has_value();
  }
  Board board(jobs, report.results);
  const Clock::time_point start = Clock::now();
  const auto work = [&] {
    while (const std::optional<std::size_t> i = board.take()) {
      std::optional<JobResult> result;
      try {
        const Job& job = jobs[*i];
        try {
          if (auto observables = simulate(job)) result = JobResult{std::move(*observables), ""};
        } catch (const Error& failed) {
          if (failed.kind() != Error::Kind::simulation) throw;
          result = JobResult{nlohmann::json::object(), failed.what()};
        }
        if (result && result->failure.empty()) keep(folder, job, *result);
      } catch (...) {
        board.stop(std::current_exception());
      }
      board.give(*i, std::move(result));
    }
  };
  std::vector<std::thread> threads;
  const std::size_t count = std::min(static_cast<std::size_t>(workers), board.to_do());
  for (std::size_t t = 0; t < count; ++t) threads.emplace_back(work);
  while (board.wait()) {
    if (hooks.interrupted && hooks.interrupted() && !board.stopped()) {
      report.interrupted = true;
      board.stop(nullptr);
    }
    if (hooks.progress) hooks.progress(progress_of(board, reused, start));
  }
  for (std::thread& t : threads) t.join();
  if (board.error()) std::rethrow_exception(board.error());
  report.progress = progress_of(board, reused, start);
  if (hooks.progress) hooks.progress(report.progress);
  return report;
}

}  // namespace repose
