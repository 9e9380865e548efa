#include "backends/dvi/collide_solid_revolved.hpp"

#include "backends/dvi/collide_box.hpp"
#include "backends/dvi/collide_plane.hpp"

namespace repose::dvi {

namespace {

/// Names within one pair: the kind and number of the body's feature, mixed with that of the surface by stride.
constexpr std::uint32_t stride = 1u << 12;
constexpr std::uint32_t edge_names = 16, circle_names = 64;

void add_corner(const Vec3& point, const PlacedProfile& b, std::uint32_t name, const ContactSink& sink) {
  collide_sphere_profile({point, 0}, b, sink, name, stride);
}

void add_edge(const Vec3& from, const Vec3& to, const PlacedProfile& b, std::uint32_t name, const ContactSink& sink) {
  const Vec3 along = to - from;
  const double length = along.norm();
  if (!(length > 0)) return;
  const PlacedRoundCone local = to_local(PlacedRoundCone{from, along / length, length, 0, 0, 0}, b);
  collide_sides(local, 0.5 * local.length + sink.margin / b.scale, b, sink, name, stride);
}

/// Farther from the surface than the body reaches.
bool out_of_reach(const Vec3& centre, double extent, const PlacedProfile& b, const ContactSink& sink) {
  const HalfPlane at(b.to_local(centre));
  return b.scale * nearest_on_profile(b.profile, at.point).distance > extent + sink.margin;
}

/// Outward normal of the surface nearest to a point.
Vec3 nearest_normal(const Vec3& point, const PlacedProfile& b) {
  const HalfPlane at(b.to_local(point));
  return b.rotation * at.lift(nearest_on_profile(b.profile, at.point).normal);
}

/// Circles of the profile against the faces of a convex body: samples around the body's azimuth, and the least distance
/// between its neighbours by golden-section search.
template <class Distance>
void add_circles(const Vec3& centre, double extent, const Distance& distance, const PlacedProfile& b,
                 const ContactSink& sink) {
  constexpr int samples = 17;
  const Vec3 local = b.to_local(centre);
  const HalfPlane at(local);
  const double reach = (extent + sink.margin) / b.scale;
  for (int k = 0; k < b.profile.size(); ++k) {
    const Vec2& v = b.profile.point(k);
    if (!b.profile.is_convex(k) || (at.point - v).norm() > reach) continue;
    const double half = v.x() > reach ? std::asin(reach / v.x()) : 3.1415926535897932;
    const Vec3 turned(-at.radial.y(), at.radial.x(), 0);
    const auto radial = [&](double angle) { return Vec3(std::cos(angle) * at.radial + std::sin(angle) * turned); };
    const auto world = [&](double angle) { return b.to_world(v.x() * radial(angle) + Vec3(0, 0, v.y())); };
    const auto add = [&](double angle, std::uint32_t name) {
      const Vec3 p = world(angle);
      const PointDistance d = distance(p);
      const Vec3 n = b.rotation.transpose() * d.normal;
      if (!(d.distance <= sink.margin)) return;
      if (!b.profile.in_vertex_cone(k, Vec2(-n.dot(radial(angle)), -n.z()), 1e-6)) return;
      sink.add(p - 0.5 * d.distance * d.normal, d.normal, d.distance, circle_names + name + stride * (2u * static_cast<unsigned>(k) + 1));
    };
    int least = 0;
    double least_distance = std::numeric_limits<double>::infinity();
    const auto angle_of = [&](int i) { return half * (2.0 * i / (samples - 1) - 1); };
    for (int i = 0; i < samples; ++i) {
      const double d = distance(world(angle_of(i))).distance;
      if (d < least_distance) {
        least_distance = d;
        least = i;
      }
      if (i % 2 == 1) add(angle_of(i), static_cast<std::uint32_t>(i));
    }
    constexpr double golden = 0.61803398874989485;
    double low = angle_of(std::max(least - 1, 0)), high = angle_of(std::min(least + 1, samples - 1));
    for (int i = 0; i < 50; ++i) {
      const double p = high - golden * (high - low), q = low + golden * (high - low);
      if (distance(world(p)).distance <= distance(world(q)).distance)
        high = q;
      else
        low = p;
    }
    add(0.5 * (low + high), samples);
  }
}

/// A rim's four points and the straight line from its lowest one to `partner`'s lowest one.
void add_rim(const std::array<Vec3, 4>& rim, const PlacedProfile& b, std::uint32_t name, const ContactSink& sink) {
  for (std::uint32_t k = 0; k < 4; ++k) add_corner(rim[k], b, name + k, sink);
}

template <class Lathe>
auto lathe_distance(const Lathe& body, const PlacedPrimitive& placed) {
  return [points = profile_of(body, placed.scale), position = placed.position, rotation = placed.rotation](const Vec3& p) {
    const HalfPlane at(rotation.transpose() * (p - position));
    const ProfileNearest nearest = nearest_on_profile(Profile(points), at.point);
    return PointDistance{nearest.distance, rotation * at.lift(nearest.normal)};
  };
}

}  // namespace

void collide_solid_profile(const Box& a, const PlacedPrimitive& placed, const PlacedProfile& b, const ContactSink& sink) {
  const PlacedBox box = place(a, placed);
  const double extent = box.half_extents.norm();
  if (out_of_reach(box.centre, extent, b, sink)) return;
  std::array<Vec3, 8> corners;
  for (std::uint32_t c = 0; c < 8; ++c) {
    const Vec3 sign((c & 1) != 0 ? 1 : -1, (c & 2) != 0 ? 1 : -1, (c & 4) != 0 ? 1 : -1);
    corners[c] = box.centre + box.rotation * sign.cwiseProduct(box.half_extents);
    add_corner(corners[c], b, c, sink);
  }
  std::uint32_t name = edge_names;
  for (std::uint32_t c = 0; c < 8; ++c)
    for (std::uint32_t bit = 1; bit < 8; bit *= 2)
      if ((c & bit) == 0) {
        add_edge(corners[c], corners[c | bit], b, name, sink);
        name += 4;
      }
  add_circles(box.centre, extent, [&](const Vec3& p) { return point_distance(box, p); }, b, sink);
}

void collide_solid_profile(const Cylinder& a, const PlacedPrimitive& placed, const PlacedProfile& b,
                           const ContactSink& sink) {
  const double r = placed.scale * a.radius, h = placed.scale * a.half_height, extent = std::sqrt(r * r + h * h);
  if (out_of_reach(placed.position, extent, b, sink)) return;
  const Vec3 half = h * placed.rotation.col(2);
  const Vec3 low = placed.position - half, high = placed.position + half;
  const auto low_rim = rim_points(low, placed.rotation, r, nearest_normal(low, b));
  const auto high_rim = rim_points(high, placed.rotation, r, nearest_normal(high, b));
  add_rim(low_rim, b, 0, sink);
  add_rim(high_rim, b, 4, sink);
  const Vec3 lowest = rim_points(placed.position, placed.rotation, r, nearest_normal(placed.position, b))[0];
  add_edge(lowest - half, lowest + half, b, edge_names, sink);
  add_circles(placed.position, extent, lathe_distance(a, placed), b, sink);
}

void collide_solid_profile(const Cone& a, const PlacedPrimitive& placed, const PlacedProfile& b, const ContactSink& sink) {
  const double r = placed.scale * a.radius, h = placed.scale * a.height, extent = std::max(h, r);
  if (out_of_reach(placed.position, extent, b, sink)) return;
  const Vec3 apex = placed.position + h * placed.rotation.col(2);
  const auto rim = rim_points(placed.position, placed.rotation, r, nearest_normal(placed.position, b));
  add_rim(rim, b, 0, sink);
  add_corner(apex, b, 4, sink);
  add_edge(rim[0], apex, b, edge_names, sink);
  add_circles(placed.position, extent, lathe_distance(a, placed), b, sink);
}

void collide_solid_profile(const TriMesh& a, const PlacedPrimitive& placed, const PlacedProfile& b,
                           const ContactSink& sink) {
  const auto vertex = [&](int k) {
    return Vec3(placed.position + placed.rotation * (placed.scale * a.vertices[static_cast<std::size_t>(k)]));
  };
  for (int k = 0; k < static_cast<int>(a.vertices.size()); ++k)
    add_corner(vertex(k), b, 2 * static_cast<std::uint32_t>(k), sink);
  // Each edge of a closed surface occurs once in either direction.
  for (const auto& t : a.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const int i = t[k], j = t[(k + 1) % 3];
      if (i < j)
        add_edge(vertex(i), vertex(j), b, 2 * (static_cast<std::uint32_t>(i) * 65599u + static_cast<std::uint32_t>(j)) + 1,
                 sink);
    }
}

}  // namespace repose::dvi
