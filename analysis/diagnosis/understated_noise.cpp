#include "analysis/diagnosis/understated_noise.hpp"

#include "analysis/diagnosis/recorded_noise.hpp"
#include "analysis/diagnosis/score.hpp"

namespace repose::diagnosis {
namespace {

constexpr double suspicious = 1.5, no_more = 1.2, no_less = 0.8;

}  // namespace

std::map<std::string, double> understated_noise(const Problem& problem, const std::vector<std::size_t>& runs, const FitOptions& options) {
  std::map<std::string, double> found;
  std::vector<std::size_t> recorded;
  for (const std::size_t run : runs) recorded.push_back(static_cast<std::size_t>(problem.runs()[run].run - problem.bundle().runs.data()));
  for (const auto& [name, scatter] : scatter_of_samples(problem.bundle(), recorded))
    if (const auto stated = problem.bundle().noise.find(name); stated != problem.bundle().noise.end() && scatter.sd > suspicious * stated->second)
      found[name] = scatter.sd;
  if (found.empty()) return found;
  const std::map<std::string, double> left = score_of(problem, minimise(problem, start_of(problem, problem.layout({}), runs), options)).rmse;
  std::erase_if(found, [&](const auto& item) {
    const auto rms = left.find(item.first);
    return rms == left.end() || rms->second > no_more * item.second || rms->second < no_less * item.second;
  });
  return found;
}

}  // namespace repose::diagnosis
