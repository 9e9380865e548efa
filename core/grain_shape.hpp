#pragma once
/// The seven grain shapes of the source study. It names them without proportions; the defaults here are this project's.
#include <string>
#include <string_view>
#include <vector>

#include "core/shape.hpp"

namespace repose {

/// Proportions, all relative to the radius r of the main sphere. `configs/grain_shapes.yaml` holds these defaults.
struct GrainProportions {
  double ellipsoid_aspect = 1.5;         ///< semi-axes a : 1 : 1
  double twin_distance = 1.2;            ///< between the centres, < 2
  double uneven_twin_radius = 0.6;       ///< of the second sphere, < 1
  double uneven_twin_distance = 1.1;     ///< between the centres
  double cone_apex = 2.0;                ///< distance of the apex from the centre of the sphere, > 1
  Vec3 side_ellipsoid{1.2, 0.6, 0.6};    ///< semi-axes; the first is radial, centred on the sphere's surface
  Vec3 piercing_ellipsoid{2.0, 0.5, 0.5};  ///< semi-axes; coaxial with the twin

  /// Every elongation multiplied by `factor` > 0: the excess of the shape over the main sphere along the axis, that is
  /// aspect - 1, twin_distance, uneven_twin_distance + uneven_twin_radius - 1, cone_apex - 1, side_ellipsoid.x and
  /// piercing_ellipsoid.x - 1. Widths stay. A factor that takes a shape apart is an Error of make_grain_shape.
  GrainProportions with_aspect(double factor) const;
};

/// "sphere", "ellipsoid", "twin", "uneven_twin", "sphere_cone", "sphere_ellipsoid", "pierced_twin", in this order.
const std::vector<std::string>& grain_shape_names();

/// The named shape whose sphere of equal volume has diameter 1 m: scale it by a grain's size. Body frame principal,
/// mass, centre and inertia those of the union (exact to rounding). Throws Error for an unknown name.
Shape make_grain_shape(std::string_view name, const GrainProportions& proportions = {});

}  // namespace repose
