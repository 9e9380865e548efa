#include "backends/dvi/collide_solid_revolved.hpp"

#include "backends/dvi/collide_box.hpp"
#include "backends/dvi/collide_mesh.hpp"

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

void add_side(const PlacedRoundCone& side, const PlacedProfile& b, const ContactSink& sink) {
  const PlacedRoundCone local = to_local(side, b);
  const double reach = 0.5 * local.length + std::max(local.radius_start, local.radius_end) + sink.margin / b.scale;
  collide_sides(local, reach, b, sink, edge_names, stride);
}

/// Farther from the surface than the body reaches.
bool out_of_reach(const Vec3& centre, double extent, const PlacedProfile& b, const ContactSink& sink) {
  const HalfPlane at(b.to_local(centre));
  return b.scale * nearest_on_profile(b.profile, at.point).distance > extent + sink.margin;
}

double surface_distance(const Vec3& point, const PlacedProfile& b) {
  return nearest_on_profile(b.profile, HalfPlane(b.to_local(point)).point).distance;
}

/// Least f between two angles, by golden-section search.
template <class F>
double golden_section(const F& f, double low, double high) {
  constexpr double golden = 0.61803398874989485;
  for (int i = 0; i < 50; ++i) {
    const double p = high - golden * (high - low), q = low + golden * (high - low);
    if (f(p) <= f(q))
      high = q;
    else
      low = p;
  }
  return 0.5 * (low + high);
}

/// The lowest point of a rim over the surface, and those a quarter of a turn from it.
void add_rim(const Vec3& centre, const Mat3& rotation, double radius, const PlacedProfile& b, std::uint32_t name,
             const ContactSink& sink) {
  constexpr int samples = 16;
  constexpr double part = 2 * 3.1415926535897932 / samples;
  const auto at = [&](double angle) {
    return Vec3(centre + radius * (std::cos(angle) * rotation.col(0) + std::sin(angle) * rotation.col(1)));
  };
  const auto height = [&](double angle) { return surface_distance(at(angle), b); };
  // All but level: the directions fixed in the body keep the points where they were.
  double least = height(0), most = least;
  int best = 0;
  for (int k = 1; k < samples; ++k) {
    const double h = height(part * k);
    most = std::max(most, h);
    if (h < least) {
      least = h;
      best = k;
    }
  }
  double angle = 0;
  if (b.scale * (most - least) > 1e-9 * radius) angle = golden_section(height, part * (best - 1), part * (best + 1));
  for (int k = 0; k < 4; ++k)
    add_corner(at(angle + 0.25 * samples * part * k), b, name + static_cast<std::uint32_t>(k), sink);
}

/// Circles of the profile against the body: samples around the body's azimuth, and the least distance between them.
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
      sink.add(p - 0.5 * d.distance * d.normal, d.normal, d.distance,
               circle_names + name + stride * (2u * static_cast<unsigned>(k) + 1));
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
    add(golden_section([&](double angle) { return distance(world(angle)).distance; }, angle_of(std::max(least - 1, 0)),
                       angle_of(std::min(least + 1, samples - 1))),
        samples);
  }
}

template <class Lathe>
auto lathe_distance(const Lathe& body, const PlacedPrimitive& placed) {
  return
      [points = profile_of(body, placed.scale), position = placed.position, rotation = placed.rotation](const Vec3& p) {
        const HalfPlane at(rotation.transpose() * (p - position));
        const ProfileNearest nearest = nearest_on_profile(Profile(points), at.point);
        return PointDistance{nearest.distance, rotation * at.lift(nearest.normal)};
      };
}

}  // namespace

void collide_solid_profile(const Box& a, const PlacedPrimitive& placed, const PlacedProfile& b,
                           const ContactSink& sink) {
  const PlacedBox box = place(a, placed);
  const double extent = box.half_extents.norm();
  if (out_of_reach(box.centre, extent, b, sink)) return;
  const std::size_t first = sink.out->size();
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
  add_circles(
      box.centre, extent, [&](const Vec3& p) { return point_distance(box, p); }, b, sink);
  merge_repeated(*sink.out, first, 1e-6 * extent);
}

void collide_solid_profile(const Cylinder& a, const PlacedPrimitive& placed, const PlacedProfile& b,
                           const ContactSink& sink) {
  const double r = placed.scale * a.radius, h = placed.scale * a.half_height, extent = std::sqrt(r * r + h * h);
  if (out_of_reach(placed.position, extent, b, sink)) return;
  const std::size_t first = sink.out->size();
  const Vec3 axis = placed.rotation.col(2), low = placed.position - h * axis, high = placed.position + h * axis;
  add_rim(low, placed.rotation, r, b, 0, sink);
  add_rim(high, placed.rotation, r, b, 4, sink);
  add_side({low, axis, 2 * h, r, r, 0}, b, sink);
  add_circles(placed.position, extent, lathe_distance(a, placed), b, sink);
  merge_repeated(*sink.out, first, 1e-6 * extent);
}

void collide_solid_profile(const Cone& a, const PlacedPrimitive& placed, const PlacedProfile& b,
                           const ContactSink& sink) {
  const double r = placed.scale * a.radius, h = placed.scale * a.height, extent = std::max(h, r);
  if (out_of_reach(placed.position, extent, b, sink)) return;
  const std::size_t first = sink.out->size();
  const Vec3 axis = placed.rotation.col(2), apex = placed.position + h * axis;
  add_rim(placed.position, placed.rotation, r, b, 0, sink);
  add_corner(apex, b, 4, sink);
  // Balls that touch the side from within, the last one at the rim: its centre lies r^2 / h below the base.
  const double sine = r / std::sqrt(r * r + h * h), length = h + r * r / h;
  add_side({apex, -axis, length, 0, length * sine, -sine}, b, sink);
  add_circles(placed.position, extent, lathe_distance(a, placed), b, sink);
  merge_repeated(*sink.out, first, 1e-6 * extent);
}

void collide_solid_profile(const TriMesh& a, const PlacedPrimitive& placed, const PlacedProfile& b,
                           const ContactSink& sink) {
  const std::size_t first = sink.out->size();
  double extent = 0;
  for (const Vec3& v : a.vertices) extent = std::max(extent, placed.scale * v.norm());
  if (out_of_reach(placed.position, extent, b, sink)) return;
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
        add_edge(vertex(i), vertex(j), b,
                 2 * (static_cast<std::uint32_t>(i) * 65599u + static_cast<std::uint32_t>(j)) + 1, sink);
    }
  const PlacedMesh mesh{a, placed.position, placed.rotation, placed.scale};
  add_circles(
      placed.position, extent, [&](const Vec3& p) { return point_distance(mesh, p); }, b, sink);
  merge_repeated(*sink.out, first, 1e-6 * extent);
}

}  // namespace repose::dvi
