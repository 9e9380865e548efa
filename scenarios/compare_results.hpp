#pragma once
/// The runs of a comparison, in order: by backend, by refinement, by seed.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/motion_field.hpp"
#include "scenarios/compare_run.hpp"
#include "scenarios/jobs.hpp"

namespace repose {

/// One side of a comparison. The same backend may stand on both sides: the label then tells them apart.
struct Contender {
  std::string label;
  const Backend* backend = nullptr;
  std::vector<std::string> unsupported;
};

enum class Refinement : std::uint8_t { none, half_step, tenth_tolerance };
inline constexpr Refinement refinements[] = {Refinement::none, Refinement::half_step, Refinement::tenth_tolerance};

/// A scene as one backend runs it.
struct CompareVariant {
  std::size_t contender = 0;
  Refinement refinement = Refinement::none;
  Scene scene;
};

/// Everything that is known before the runs.
struct Comparison {
  std::vector<Contender> contenders;
  std::vector<CompareVariant> variants;
  std::vector<Job> jobs;            ///< Job::scene: index into variants; all seeds of a variant, then the next
  std::size_t seeds = 1;
  bool random = false;              ///< false: the seed changes nothing (no grains)
  double tolerance = 0;             ///< relative, of the scene's solver
  CompareFrames frames;
  std::optional<FieldGrid> grid;    ///< with grains
  std::size_t grains = 0;
};

/// The jobs' results, looked up by what they are of.
class CompareResults {
 public:
  CompareResults(const Comparison& comparison, const JobsReport& report);

  /// nullptr if the run failed, or was not asked for.
  const nlohmann::json* run(std::size_t contender, Refinement refinement, std::size_t seed) const;
  bool has(std::size_t contender, Refinement refinement) const;
  std::size_t failed(std::size_t contender) const;  ///< of all its runs

  std::optional<double> value(std::size_t contender, Refinement refinement, std::size_t seed, const std::string& observable) const;
  /// All values over the seeds; missing ones are left out.
  std::vector<double> values(std::size_t contender, Refinement refinement, const std::string& observable) const;
  using Pairs = std::pair<std::vector<double>, std::vector<double>>;
  /// Values of seeds that both sides have.
  Pairs paired(std::size_t a, Refinement refinement_a, std::size_t b, Refinement refinement_b, const std::string& observable) const;
  /// unit, kind and scale (the largest of all runs) of an observable; null if no run has it.
  nlohmann::json description(const std::string& observable) const;
  std::vector<std::string> observables() const;  ///< of any run, in order of name

 private:
  const Comparison& comparison_;
  std::vector<const nlohmann::json*> runs_;  // contender, refinement, seed
};

}  // namespace repose
