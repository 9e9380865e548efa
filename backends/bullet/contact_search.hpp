#pragma once
/// All contact points of the bodies in their present state.
///
/// Pairs come from Bullet's bounding-volume trees (pair_search.hpp). Points come from
///   two spheres                                                      their centres
///   a sphere or ellipsoid with any convex primitive, two round cones Bullet's GJK (convex_shape.hpp): one point
///   all others, and overlap too deep for GJK: flat faces, edges, sides; half-spaces; hollows       the exact geometry of backends/dvi/narrow_phase.hpp
/// Bullet knows no solid of revolution, builds the points of a face up over several steps from a cache of old ones (history
/// that no checkpoint could hold), and takes meshes as loose triangles whose inner edges make a grain stumble.
///
/// Every step starts afresh: no point is older than its step.
#include <cstdint>
#include <vector>

#include "backends/bullet/bodies.hpp"
#include "backends/bullet/convex_shape.hpp"
#include "backends/bullet/pair_search.hpp"

namespace repose::bullet {

/// A contact point with what tells it from all others for as long as it lasts.
struct FoundContact {
  std::int32_t a = 0, b = 0;       ///< bodies, a < b
  std::uint64_t features = 0;      ///< part of a << 48 | part of b << 32 | feature of the pair
  dvi::ContactPoint point;         ///< normal from a to b
};

class ContactSearch {
 public:
  explicit ContactSearch(const Bodies& bodies);

  /// Sorted by bodies and features. Kept are points within the cohesion range, and those with
  ///   gap <= h |largest approach of the two| + margin (R/50 + h v/4),   R the smaller radius, v the faster of the two,
  /// all velocities being those without contacts. Bodies that do not exist at this time have no contacts, and a body with
  /// `active` times has none where it overlaps by more than its gate_tolerance.
  const std::vector<FoundContact>& find(double h, double margin);

 private:
  struct PlacedPart {
    std::size_t body = 0;
    dvi::PlacedPrimitive primitive;
    ConvexShapePointer convex;   ///< null: not convex
    Vec3 centre, half;           ///< of its box, in its own frame, scaled; infinite: unbounded
    double bound = 0;            ///< radius of the ball about its origin
  };

  void place(double h, double margin);
  double slack(std::size_t body, double h) const;
  double cohesion_range(std::size_t a, std::size_t b) const;
  void collide(std::int32_t a, std::int32_t b, double h, double margin);
  void collide(const PlacedPart& x, const PlacedPart& y, double reach);

  const Bodies& bodies_;
  std::vector<PlacedPart> parts_;
  std::vector<std::size_t> first_part_;     ///< per body, plus the end
  std::vector<double> bound_;               ///< per body: radius of the ball about its centre
  std::vector<double> radius_;              ///< per body: R
  std::vector<std::int32_t> unbounded_;     ///< half-spaces
  double widest_cohesion_ = 0;
  std::vector<double> speed_;               ///< per body, of its fastest point
  std::vector<char> present_;
  PairSearch search_;
  std::vector<dvi::ContactPoint> scratch_;
  std::vector<FoundContact> found_;
};

}  // namespace repose::bullet
