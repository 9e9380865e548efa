#pragma once
/// The Minkowski difference of two convex cores, and the searches in it. Internal to collide_convex.
#include "backends/dvi/collide_support.hpp"

namespace repose::dvi {

/// A point a - b of the difference of the cores, with its two origins (relative to the centre of the first body).
struct DifferencePoint {
  Vec3 w = Vec3::Zero(), on_a = Vec3::Zero(), on_b = Vec3::Zero();
};

struct Difference {
  const ConvexBody& a;
  const ConvexBody& b;

  DifferencePoint support(const Vec3& d) const {
    DifferencePoint p;
    p.on_a = a.support(d) - a.centre;
    p.on_b = b.support(-d) - a.centre;
    p.w = p.on_a - p.on_b;
    return p;
  }
  double size() const { return a.extent + b.extent; }
};

/// The point of the difference nearest to the origin.
struct CoreDistance {
  enum class State { apart, touching, beyond } state = State::apart;
  DifferencePoint nearest;  ///< valid if apart; |nearest.w| is the distance
  double distance = 0;
};
/// GJK. `beyond`: farther than `margin`; `touching`: closer than rounding can tell, or overlapping.
CoreDistance core_distance(const Difference& difference, double margin);

/// Expanding polytope: the boundary point of the difference nearest to the origin, which lies inside (or outside by no
/// more than rounding).
struct CoreDepth {
  Vec3 normal = Vec3::UnitZ();  ///< outward, of the difference: the direction in which b must move
  double depth = 0;
  DifferencePoint nearest;
};
CoreDepth core_depth(const Difference& difference);

}  // namespace repose::dvi
