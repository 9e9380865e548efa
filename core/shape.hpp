#pragma once
/// Shapes: rigid unions of convex or revolved primitives. Lengths in [m]; a primitive is given in its own frame.
#include <array>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "core/math.hpp"

namespace repose {

struct Sphere {
  double radius = 0;  ///< > 0, centre at the origin
};

struct Ellipsoid {
  Vec3 semi_axes = Vec3::Zero();  ///< along x, y, z, each > 0; centre at the origin
};

/// Convex hull of two spheres on the x axis: radius_a at x = 0, radius_b at x = length. With radius_b = 0 it is a
/// sphere with its tangent cone. Needs length > |radius_a - radius_b| (else it is a sphere).
struct RoundCone {
  double radius_a = 0, radius_b = 0, length = 0;
};

/// Right circular cone with a flat base: base disc in the plane z = 0, apex at (0, 0, height).
struct Cone {
  double radius = 0, height = 0;
};

struct Box {
  Vec3 half_extents = Vec3::Zero();  ///< each > 0; centre at the origin
};

/// Right circular cylinder about the z axis, centre at the origin.
struct Cylinder {
  double radius = 0, half_height = 0;
};

/// All points with normal . x <= 0. Infinite: only for fixed or prescribed bodies.
struct HalfSpace {
  Vec3 normal = Vec3::UnitZ();  ///< unit, points out of the solid
};

/// A solid of revolution about the z axis: the polygon `profile` of points (r, z), r >= 0, counterclockwise in the
/// (r, z) plane (solid on the left of each edge), closed from the last point to the first. Its surface is smooth in the
/// azimuth: funnels, discs, rims, trenches, rollers and drums are made of it. Only for fixed or prescribed bodies.
struct Revolved {
  std::vector<Vec2> profile;  ///< at least three points, no self-intersection
};

/// A closed triangle mesh, counterclockwise seen from outside.
struct TriMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;
};

using Primitive = std::variant<Sphere, Ellipsoid, RoundCone, Cone, Box, Cylinder, HalfSpace, Revolved, TriMesh>;

/// A primitive placed in the frame of its shape.
struct Part {
  Primitive primitive;
  Pose pose;
};

/// Mass, centre and inertia of a solid of unit density.
struct MassProperties {
  double volume = 0;                        ///< [m^3]
  Vec3 centre = Vec3::Zero();               ///< [m]
  Mat3 inertia = Mat3::Zero();              ///< about the centre, axes of the frame it was computed in [m^5]
};

/// A rigid union of parts (overlap counts once). `kind` is the name a user knows it by: "sphere", "twin", ...
/// After `principal()` the frame is the body frame: origin at the centre of mass, axes principal.
struct Shape {
  std::string kind;
  std::vector<Part> parts;
  MassProperties mass;            ///< of the union at unit density, in the frame of the parts
  Pose own_frame;                 ///< the frame the user described the shape in, seen from the body frame
  double bounding_radius = 0;     ///< of the ball about the origin that holds the shape [m]; infinite for a half-space

  bool bounded() const { return bounding_radius < std::numeric_limits<double>::infinity(); }
};

/// Builds a shape from parts: validates each, computes the mass of the union, turns the frame principal.
/// A shape with a half-space or a revolved solid keeps its frame, and its `mass` stays zero: it cannot be dynamic.
/// Throws Error.
Shape make_shape(std::string kind, std::vector<Part> parts);

/// Radius of the ball about the primitive's own origin that holds it [m].
double bounding_radius(const Primitive& primitive);

/// The thinnest dimension of the primitive [m], for plausibility checks: a grain that moves this far in a step may pass
/// through. Revolved: its shortest edge; mesh: the shortest side of its bounding box; half-space: infinite.
double smallest_extent(const Primitive& primitive);

/// True if the point [m] (in the primitive's frame) lies inside or on it. For tests and for packing fractions.
bool contains(const Primitive& primitive, const Vec3& point);

/// True if the point (in the shape's body frame) lies in any part.
bool contains(const Shape& shape, const Vec3& point);

/// The primitive scaled uniformly about its own origin by `factor` > 0.
Primitive scaled(const Primitive& primitive, double factor);

/// The part scaled about the origin of its shape.
Part scaled(const Part& part, double factor);

}  // namespace repose
