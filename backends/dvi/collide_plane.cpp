#include "backends/dvi/collide_plane.hpp"

#include "backends/dvi/collide_round_cone.hpp"

namespace repose::dvi {

namespace {

void add_point(const Vec3& point, const PlacedPlane& plane, std::uint32_t feature, const ContactSink& sink) {
  const double gap = plane.normal.dot(point - plane.point);
  sink.add(point - 0.5 * gap * plane.normal, -plane.normal, gap, feature);
}

}  // namespace

std::array<Vec3, 4> rim_points(const Vec3& centre, const Mat3& rotation, double radius, const Vec3& up) {
  Vec3 down = -(rotation.transpose() * up);
  down.z() = 0;
  const double tilt = down.norm();
  // Upright up to rounding: a direction fixed in the body keeps the points where they were.
  down = tilt > 1e-9 ? Vec3(down / tilt) : Vec3(Vec3::UnitX());
  const Vec3 u = radius * (rotation * down), v = radius * (rotation * Vec3(-down.y(), down.x(), 0));
  return {centre + u, centre + v, centre - v, centre - u};
}

void collide_plane(const Sphere& body, const PlacedPrimitive& placed, const PlacedPlane& plane,
                   const ContactSink& sink) {
  const PlacedSphere s = place(body, placed);
  const double gap = plane.normal.dot(s.centre - plane.point) - s.radius;
  sink.add(s.centre - (s.radius + 0.5 * gap) * plane.normal, -plane.normal, gap, 0);
}

void collide_plane(const Ellipsoid& body, const PlacedPrimitive& placed, const PlacedPlane& plane,
                   const ContactSink& sink) {
  const PlacedEllipsoid a = place(body, placed);
  const Vec3 local = a.semi_axes.cwiseProduct(a.rotation.transpose() * plane.normal);
  const double h = local.norm();
  const double gap = plane.normal.dot(a.centre - plane.point) - h;
  if (!(gap <= sink.margin)) return;
  const Vec3 lowest = a.centre - a.rotation * a.semi_axes.cwiseProduct(local) / h;
  sink.add(lowest - 0.5 * gap * plane.normal, -plane.normal, gap, 0);
}

void collide_plane(const RoundCone& body, const PlacedPrimitive& placed, const PlacedPlane& plane,
                   const ContactSink& sink) {
  collide_round_cone_plane(place(body, placed), plane.point, plane.normal, sink);
}

void collide_plane(const Box& body, const PlacedPrimitive& placed, const PlacedPlane& plane, const ContactSink& sink) {
  const PlacedBox box = place(body, placed);
  for (std::uint32_t corner = 0; corner < 8; ++corner) {
    const Vec3 local((corner & 1) != 0 ? box.half_extents.x() : -box.half_extents.x(),
                     (corner & 2) != 0 ? box.half_extents.y() : -box.half_extents.y(),
                     (corner & 4) != 0 ? box.half_extents.z() : -box.half_extents.z());
    add_point(box.centre + box.rotation * local, plane, corner, sink);
  }
}

void collide_plane(const Cylinder& body, const PlacedPrimitive& placed, const PlacedPlane& plane,
                   const ContactSink& sink) {
  const double radius = placed.scale * body.radius;
  const Vec3 half = placed.scale * body.half_height * placed.rotation.col(2);
  const bool top_is_low = half.dot(plane.normal) < 0;
  const Vec3 low = placed.position + (top_is_low ? half : Vec3(-half));
  const Vec3 high = placed.position - (top_is_low ? half : Vec3(-half));
  // A cylinder on its side changes its lower end freely: the features name the ends, not their order.
  const std::uint32_t low_end = top_is_low ? 4 : 0, high_end = 4 - low_end;
  const std::array<Vec3, 4> rim = rim_points(low, placed.rotation, radius, plane.normal);
  for (std::uint32_t k = 0; k < 4; ++k) add_point(rim[k], plane, low_end + k, sink);
  add_point(rim_points(high, placed.rotation, radius, plane.normal)[0], plane, high_end, sink);
}

void collide_plane(const Cone& body, const PlacedPrimitive& placed, const PlacedPlane& plane, const ContactSink& sink) {
  const std::array<Vec3, 4> rim =
      rim_points(placed.position, placed.rotation, placed.scale * body.radius, plane.normal);
  for (std::uint32_t k = 0; k < 4; ++k) add_point(rim[k], plane, k, sink);
  add_point(placed.position + placed.scale * body.height * placed.rotation.col(2), plane, 4, sink);
}

void collide_plane(const TriMesh& body, const PlacedPrimitive& placed, const PlacedPlane& plane,
                   const ContactSink& sink) {
  std::uint32_t feature = 0;
  for (const Vec3& vertex : body.vertices)
    add_point(placed.position + placed.rotation * (placed.scale * vertex), plane, feature++, sink);
}

}  // namespace repose::dvi
