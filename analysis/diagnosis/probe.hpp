#pragma once
/// Tests of directions in the space of residuals, against the largest that noise alone would give.
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace repose::diagnosis {

/// Orthonormal columns along which an effect changes the residuals. One-sided (one column): only a residual against the direction
/// counts, for an effect of the other sign does not exist.
struct Probe {
  Eigen::MatrixXd basis;
  bool one_sided = false;
};

/// gain = |Q^T r|^2, twice a log likelihood ratio; one-sided: 0 where Q^T r > 0.
double gain_of(const Probe& probe, const Eigen::VectorXd& residual);

/// The gain of k directions as a normal deviate (Wilson & Hilferty 1931), so that probes of different k can be compared:
///   z = ((gain / k)^(1/3) - 1 + 2 / (9 k)) / sqrt(2 / (9 k));    no probe: -infinity
double deviate(double gain, Eigen::Index k);

/// sqrt(-2 ln P(chi^2 of k degrees >= gain)): nearly the normal deviate, and of the same order as the tail far out in it too, where the cube root of
/// deviate() takes few degrees for weaker than they are.
double strength(double gain, Eigen::Index k);

/// Share of pure noise of so many degrees of freedom that reaches chi^2.
double p_of_chi2(double chi2, Eigen::Index degrees);

/// Largest deviates of draws of pure noise over a set of probes.
struct NullDistribution {
  std::vector<double> largest;  ///< ascending
  /// Share of the draws that reach it, corrected for the number of draws: never below 1 / (draws + 1).
  double p(double deviate) const;
};
/// Noise as `residual` has it: its values in another order and with any sign, brought to an rms of 1 (or as much above as noise may be stated too small, a
/// tenth), for sensors have outliers that no normal distribution has, and a few of them look like a force. Of fewer than 30 samples normal numbers.
NullDistribution null_of(const std::vector<Probe>& probes, const Eigen::VectorXd& residual, int replicas, std::uint64_t seed);

}  // namespace repose::diagnosis
