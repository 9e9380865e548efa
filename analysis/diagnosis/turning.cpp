#include "analysis/diagnosis/turning.hpp"

#include <cmath>
#include <optional>

#include "analysis/diagnosis/measurement.hpp"

namespace repose::diagnosis {

std::array<std::vector<double>, 3> turns_of(const std::vector<Quat>& orientation) {
  std::array<std::vector<double>, 3> turns;
  Vec3 turn = Vec3::Zero();
  std::optional<Quat> before;
  for (const Quat& q : orientation) {
    const bool there = std::isfinite(q.w());
    if (there) {
      if (before) turn += rotation_vector(q * before->conjugate());
      before = q;
    }
    for (std::size_t k = 0; k < 3; ++k) turns[k].push_back(there ? turn[static_cast<Eigen::Index>(k)] : NAN);
  }
  return turns;
}

}  // namespace repose::diagnosis
