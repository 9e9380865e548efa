#pragma once
/// Parameters that the data determine only together: a mass and a drag coefficient seen through their ratio alone.
#include <vector>

#include <Eigen/Core>

namespace repose::diagnosis {

/// Groups of two or more parameters whose common change leaves the fit as it is: directions of the information matrix
/// J^T J (scaled to a unit diagonal) with an eigenvalue below 1e-5. Two parameters reach that at a correlation of 0.99999,
/// beyond which derivatives by differences tell nothing. Parameters that move nothing at all are in no group.
std::vector<std::vector<std::size_t>> only_together(const Eigen::MatrixXd& information);

}  // namespace repose::diagnosis
