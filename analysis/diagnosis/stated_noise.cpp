#include "analysis/diagnosis/stated_noise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/diagnosis/recorded_noise.hpp"
#include "analysis/diagnosis/score.hpp"

namespace repose::diagnosis {
namespace {

constexpr double suspicious = 1.5, no_more = 1.2, no_less = 0.8;
constexpr double hides = 0.1;  // of the stated noise

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

std::map<std::string, double> overstated_noise(const Problem& problem, const Fit& fit) {
  std::map<std::string, std::pair<double, double>> squares;  // sum, count
  for (const std::size_t run : fit.runs) {
    const Eigen::VectorXd plain = problem.plain_residual(fit.layout, run, fit.shared, fit.own[run]);
    for (const Channel& c : problem.runs()[run].channels) {
      if (plain.size() == 0) continue;
      squares[c.observable].first += plain.segment(c.first, static_cast<Eigen::Index>(c.time.size())).squaredNorm();
      squares[c.observable].second += static_cast<double>(c.time.size());
    }
  }
  std::map<std::string, double> overstated;
  for (const auto& [name, square] : squares)
    if (const double rms = std::sqrt(square.first / std::max(1.0, square.second)); rms < hides && problem.bundle().noise.contains(name)) overstated[name] = rms;
  return overstated;
}

}  // namespace repose::diagnosis
