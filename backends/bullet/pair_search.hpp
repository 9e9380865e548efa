#pragma once
/// Pairs of boxes that may overlap, by Bullet's dynamic bounding-volume trees (btDbvtBroadphase).
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/math.hpp"

namespace repose::bullet {

class PairSearch {
 public:
  /// One box per body; pairs of two bodies that are both fixed are never reported.
  explicit PairSearch(const std::vector<char>& fixed);
  ~PairSearch();

  /// The axis-aligned box of a body, finite.
  void set_box(std::int32_t body, const Vec3& low, const Vec3& high);

  /// Every pair (a, b), a < b, whose boxes overlap, and perhaps some that nearly do; sorted. What the trees went through
  /// before does not show in the order.
  const std::vector<std::pair<std::int32_t, std::int32_t>>& pairs();

 private:
  struct Trees;
  std::unique_ptr<Trees> trees_;
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs_;
};

}  // namespace repose::bullet
