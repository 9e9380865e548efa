#include "analysis/diagnosis/combination.hpp"

#include <cmath>

#include <Eigen/Dense>

namespace repose::diagnosis {

std::vector<std::vector<std::size_t>> only_together(const Eigen::MatrixXd& information) {
  constexpr double nothing = 1e-5, takes_part = 0.2;
  std::vector<std::size_t> seen;
  for (Eigen::Index i = 0; i < information.rows(); ++i)
    if (information(i, i) > 0) seen.push_back(static_cast<std::size_t>(i));
  const auto n = static_cast<Eigen::Index>(seen.size());
  Eigen::MatrixXd scaled(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto a = static_cast<Eigen::Index>(seen[static_cast<std::size_t>(i)]);
      const auto b = static_cast<Eigen::Index>(seen[static_cast<std::size_t>(j)]);
      scaled(i, j) = information(a, b) / std::sqrt(information(a, a) * information(b, b));
    }
  std::vector<std::vector<std::size_t>> groups;
  if (n < 2) return groups;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  for (Eigen::Index k = 0; k < n && solver.eigenvalues()[k] < nothing; ++k) {
    std::vector<std::size_t> group;
    for (Eigen::Index i = 0; i < n; ++i)
      if (std::abs(solver.eigenvectors()(i, k)) > takes_part) group.push_back(seen[static_cast<std::size_t>(i)]);
    if (group.size() > 1) groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace repose::diagnosis
