#pragma once
/// Which effects could explain what is left of the nominal fit: a coarse search over each effect's parameters.
///
/// At every point of the search the residuals r' of the extended model give a direction d = r' - r. With what the nuisance can imitate
/// taken out of it, q = (I - P_J) d / |...|, the first-order gain of the effect in this direction is (q^T r)^2 where q^T r < 0.
#include <string>
#include <vector>

#include "analysis/diagnosis/nuisance.hpp"
#include "analysis/diagnosis/probe.hpp"

namespace repose::diagnosis {

struct Screened {
  Term term;
  double deviate = 0;                 ///< of the probe that stands out most
  double reached = 0;                 ///< smallest chi^2 over the search, nuisance taken out; of the nominal: `reached` of nothing
  std::vector<double> shared_start;   ///< the term's shared parameters there
  std::vector<std::vector<double>> tried;  ///< all points of the first search
  bool from_data = false;             ///< reached from the start values as read off the data, not from the nominal fit's
  std::vector<Probe> probes;
};

/// The search: the first parameter log-spaced (`points` values) or at both signs, each component of a vector alone; further
/// logarithmic parameters (frequencies, ranges) in turn at a small first one, waves twice as densely and at two phases. Where the nominal fit is poor its start values are
/// distorted: then also from the start values as read off the data. Points that lie in the right direction but too far are tried
/// again as near as a straight line promises most.
Screened screen(const Problem& problem, const Fit& nominal, const Nuisance& nuisance, const Term& term, int points);

/// All probes of a list.
std::vector<Probe> probes_of(const std::vector<Screened>& screened);

/// A second effect beside a fitted first one, whose nuisance this is, without a simulation: the smallest chi^2 to which a direction of
/// its screening leads if residuals change along straight lines. What the first effect and the start values imitate counts for nothing.
double reached_beside(const Nuisance& first, const Screened& second);

/// Two effects that may cancel: the pairs of terms whose best two probes together gain most, best first, each at least
/// `least` more than the better of the two alone.
struct ScreenedPair {
  std::size_t first = 0, second = 0;  ///< of the list
  double gain = 0;
};
std::vector<ScreenedPair> screen_pairs(const std::vector<Screened>& screened, const Eigen::VectorXd& residual, double least);

}  // namespace repose::diagnosis
