#include "analysis/diagnosis/quarter_turn.hpp"

#include <cmath>

namespace repose::diagnosis {
namespace {

constexpr double same_fit = 0.1;  // of chi^2: what rounding and a solver's tolerance make of one law

bool is_calibrated_friction(const Parameter& p) { return p.effect.empty() && p.key.starts_with("pairs.") && p.key.ends_with(".friction"); }

/// How far the calibrated coefficients of friction are from where they began, in ln.
double distance_from_start(const Fit& fit) {
  double distance = 0;
  for (std::size_t i = 0; i < fit.layout.shared.size(); ++i)
    if (const Parameter& p = fit.layout.shared[i]; is_calibrated_friction(p) && p.start > 0)
      distance += std::abs(std::log(fit.shared[static_cast<Eigen::Index>(i)] / p.start));
  return distance;
}

}  // namespace

std::optional<Fit> turned_by_a_quarter(const Problem& problem, const Fit& fit) {
  Eigen::Index ratio = -1, direction = -1;
  bool calibrated = false;
  for (std::size_t i = 0; i < fit.layout.shared.size(); ++i) {
    const Parameter& p = fit.layout.shared[i];
    calibrated = calibrated || is_calibrated_friction(p);
    if (p.effect != "anisotropic_friction") continue;
    (p.key.ends_with(".ratio") ? ratio : direction) = static_cast<Eigen::Index>(i);
  }
  if (!calibrated || ratio < 0 || direction < 0 || !(fit.shared[ratio] > 0)) return std::nullopt;
  Fit turned = fit;
  for (std::size_t i = 0; i < fit.layout.shared.size(); ++i)
    if (is_calibrated_friction(fit.layout.shared[i])) turned.shared[static_cast<Eigen::Index>(i)] *= fit.shared[ratio];
  turned.shared[ratio] = 1 / fit.shared[ratio];
  turned.shared[direction] += fit.shared[direction] > 0 ? -90 : 90;
  for (std::size_t i = 0; i < turned.layout.shared.size(); ++i) {
    const double value = turned.shared[static_cast<Eigen::Index>(i)];
    if (value < turned.layout.shared[i].lower || value > turned.layout.shared[i].upper) return std::nullopt;
  }
  turned = evaluated(problem, std::move(turned));
  if (!(std::abs(turned.chi2 - fit.chi2) < same_fit)) return std::nullopt;  // friction that is not free tells them apart
  return turned;
}

Fit nearer_to_the_scene(const Problem& problem, const Fit& fit) {
  std::optional<Fit> turned = turned_by_a_quarter(problem, fit);
  return turned && distance_from_start(*turned) < distance_from_start(fit) ? *std::move(turned) : fit;
}

}  // namespace repose::diagnosis
