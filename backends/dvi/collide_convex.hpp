#pragma once
/// Any two convex bodies: distance by GJK, depth by an expanding polytope, contact points by clipping facing features.
#include "backends/dvi/collide_support.hpp"

namespace repose::dvi {

/// Signed gap, its direction and the witness points on the two surfaces.
///
/// GJK (Gilbert, Johnson & Keerthi 1988) on the cores while they are apart; else the polytope inside the Minkowski
/// difference is expanded towards the origin's nearest boundary point (van den Bergen 2001): the global minimum of the
/// depth. Exact for polytopes; on curved bodies to about 1e-9 of their size in the gap.
struct ConvexGap {
  Vec3 normal = Vec3::UnitZ();  ///< from a to b
  double gap = 0;
  Vec3 on_a = Vec3::Zero(), on_b = Vec3::Zero();
  bool beyond = false;  ///< farther apart than the margin; the rest is not set
};
ConvexGap convex_gap(const ConvexBody& a, const ConvexBody& b, double margin);

/// Adds the contact `found`, or up to four points where faces or edges lie along each other (box on box: four, cylinder
/// on its side: two). Each point's gap is measured along the common normal. Features from `feature_offset` on, below
/// 2^18.
void add_contacts(const ConvexBody& a, const ConvexBody& b, const ConvexGap& found, const ContactSink& sink,
                  std::uint32_t feature_offset);

void collide_convex(const ConvexBody& a, const ConvexBody& b, const ContactSink& sink);

}  // namespace repose::dvi
