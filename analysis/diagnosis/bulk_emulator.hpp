#pragma once
/// A smooth guess of what an expensive simulation would give between the few points where it was run: a Gaussian process.
///
///   y(u) = beta + f(u) + e,   f ~ GP(0, tau^2 m(r)),   e ~ N(0, s_i^2),   r^2 = sum_k ((u_k - u'_k) / l_k)^2
///   m(r) = (1 + sqrt(5) r + 5/3 r^2) exp(-sqrt(5) r)      Matern 5/2: twice differentiable, no smoother than physics is
///
/// Axes in groups (the coefficients of two effects, searched together) act for themselves and together, a priori equally much:
///
///   k(u, u') = tau^2 (sum_g m(r_g) + m(r)) / (groups + 1),   r_g over the axes of one group alone
///
/// so that what is known of each effect alone is carried into the square (Duvenaud, Nickisch & Rasmussen 2011, additive Gaussian processes).
///
/// s_i^2, the scatter between seeds over the number of seeds at the point, is known; beta has a wide normal prior. tau and the
/// lengths l_k maximise the likelihood times weak log-normal priors (l about 0.5 of the range, within a factor of e or so), which
/// decide while there are fewer points than a likelihood needs. Rasmussen & Williams, Gaussian Processes for Machine Learning, 2006.
/// For a few hundred points at most: the cost grows with their cube.
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace repose::diagnosis {

class Emulator {
 public:
  /// `points`: one row each, in the unit cube; `values` finite; `noise_variance` > 0; `groups`: the group 0, 1, ... of each axis, empty: all are one.
  /// Throws Error if they do not match or there are none.
  Emulator(const Eigen::MatrixXd& points, const Eigen::VectorXd& values, const Eigen::VectorXd& noise_variance, std::vector<int> groups = {});

  struct Prediction {
    double mean = 0;
    double variance = 0;  ///< of the mean of all seeds there, not of one run
  };
  Prediction at(const Eigen::VectorXd& point) const;

  const Eigen::VectorXd& lengths() const { return lengths_; }
  double sd() const { return scale_ * tau_; }  ///< tau, in the unit of the values

 private:
  Eigen::MatrixXd points_;
  std::vector<int> groups_;
  Eigen::VectorXd lengths_, weights_;
  double centre_ = 0, scale_ = 1, tau_ = 1;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace repose::diagnosis
