#include "analysis/diagnosis/understated_noise.hpp"

#include <cmath>

#include "analysis/diagnosis/recorded_noise.hpp"

namespace repose::diagnosis {
namespace {

constexpr double suspicious = 1.5, no_more = 1.2, no_less = 0.8;

/// Rms of what the fit leaves, by observable [SI].
std::map<std::string, double> left_by(const Problem& problem, const Fit& fit) {
  std::map<std::string, double> squares, counts;
  for (const std::size_t run : fit.runs) {
    const Eigen::VectorXd r = problem.plain_residual(fit.layout, run, fit.shared, fit.own[run]);
    if (r.size() == 0) return {};
    for (const Channel& c : problem.runs()[run].channels) {
      squares[c.observable] += c.noise * c.noise * r.segment(c.first, static_cast<Eigen::Index>(c.time.size())).squaredNorm();
      counts[c.observable] += static_cast<double>(c.time.size());
    }
  }
  for (auto& [name, square] : squares) square = std::sqrt(square / std::max(1.0, counts[name]));
  return squares;
}

}  // namespace

std::map<std::string, double> understated_noise(const Problem& problem, const std::vector<std::size_t>& runs, const FitOptions& options) {
  std::map<std::string, double> found;
  std::vector<std::size_t> recorded;
  for (const std::size_t run : runs) recorded.push_back(static_cast<std::size_t>(problem.runs()[run].run - problem.bundle().runs.data()));
  for (const auto& [name, scatter] : scatter_of_samples(problem.bundle(), recorded))
    if (const auto stated = problem.bundle().noise.find(name); stated != problem.bundle().noise.end() && scatter.sd > suspicious * stated->second)
      found[name] = scatter.sd;
  if (found.empty()) return found;
  const std::map<std::string, double> left = left_by(problem, minimise(problem, start_of(problem, problem.layout({}), runs), options));
  std::erase_if(found, [&](const auto& item) {
    const auto rms = left.find(item.first);
    return rms == left.end() || rms->second > no_more * item.second || rms->second < no_less * item.second;
  });
  return found;
}

}  // namespace repose::diagnosis
