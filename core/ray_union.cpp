#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/overloaded.hpp"
#include "core/union_integrals.hpp"

namespace repose {
namespace {

using Chord = std::pair<double, double>;  // from > to: none
constexpr Chord none{1, 0};

struct Crossing {
  double at;
  int depth;  // +1 where the ray enters a part, -1 where it leaves
};

Chord common(const Chord& a, const Chord& b) { return {std::max(a.first, b.first), std::min(a.second, b.second)}; }

// The stretch that holds both, for a convex body made of two pieces.
Chord joined(const Chord& a, const Chord& b) {
  if (a.first >= a.second) return b;
  if (b.first >= b.second) return a;
  return {std::min(a.first, b.first), std::max(a.second, b.second)};
}

Chord slab(double origin, double direction, double lower, double upper) {
  const double s = (lower - origin) / direction, t = (upper - origin) / direction;
  return {std::min(s, t), std::max(s, t)};
}

Chord ball_chord(const Vec3& o, const Vec3& d, double radius) {
  const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - radius * radius;
  const double discriminant = b * b - a * c;
  if (discriminant <= 0) return none;
  const double root = std::sqrt(discriminant);
  return {(-b - root) / a, (-b + root) / a};
}

// The frustum between s = from (radius r0) and s = to (radius r1), s: the first coordinate.
Chord frustum_chord(const Vec3& o, const Vec3& d, double from, double to, double r0, double r1) {
  const Chord within = slab(o.x(), d.x(), from, to);
  const double k = (r1 - r0) / (to - from), r = r0 + k * (o.x() - from), dr = k * d.x();
  const double a = d.y() * d.y() + d.z() * d.z() - dr * dr, b = o.y() * d.y() + o.z() * d.z() - r * dr,
               c = o.y() * o.y() + o.z() * o.z() - r * r;
  const double discriminant = b * b - a * c;
  if (discriminant <= 0) return a < 0 ? within : none;
  const double root = std::sqrt(discriminant), s = (-b - root) / a, t = (-b + root) / a;
  if (a > 0) return common(within, {s, t});
  // The line meets both nappes of the cone; one of the two outer stretches lies in the slab.
  const Chord before = common(within, {within.first, std::min(s, t)}),
              after = common(within, {std::max(s, t), within.second});
  return before.second - before.first > after.second - after.first ? before : after;
}

Vec3 z_first(const Vec3& v) { return {v.z(), v.x(), v.y()}; }

Chord chord(const Primitive& primitive, const Vec3& o, const Vec3& d) {
  return std::visit(
      Overloaded{
          [&](const Sphere& s) { return ball_chord(o, d, s.radius); },
          [&](const Ellipsoid& e) { return ball_chord(o.cwiseQuotient(e.semi_axes), d.cwiseQuotient(e.semi_axes), 1); },
          [&](const RoundCone& c) {
            const double sine = (c.radius_a - c.radius_b) / c.length, cosine = std::sqrt((1 - sine) * (1 + sine));
            const Chord side = frustum_chord(o, d, c.radius_a * sine, c.length + c.radius_b * sine, c.radius_a * cosine,
                                             c.radius_b * cosine);
            const Chord ends =
                joined(ball_chord(o, d, c.radius_a), ball_chord(o - c.length * Vec3::UnitX(), d, c.radius_b));
            return joined(side, ends);
          },
          [&](const Cone& c) { return frustum_chord(z_first(o), z_first(d), 0, c.height, c.radius, 0); },
          [&](const Box& b) {
            const Vec3& h = b.half_extents;
            return common(slab(o.x(), d.x(), -h.x(), h.x()),
                          common(slab(o.y(), d.y(), -h.y(), h.y()), slab(o.z(), d.z(), -h.z(), h.z())));
          },
          [&](const Cylinder& c) {
            return frustum_chord(z_first(o), z_first(d), -c.half_height, c.half_height, c.radius, c.radius);
          },
          [](const HalfSpace&) -> Chord {
            throw Error("", "a half-space has no finite mass", "use it for a fixed body only");
          },
          [](const Revolved&) -> Chord {
            throw Error("", "a revolved solid that overlaps other parts has no mass here",
                        "use it for a fixed body only");
          },
          [](const TriMesh&) { return none; },
      },
      primitive);
}

// A mesh with its vertices in the frame of the rays: x, y across, z along.
struct RayMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;

  // On which side of the line a-b the point lies; the same bits for b-a reversed, so that neighbours leave no gap.
  bool left(int a, int b, double x, double y) const {
    const Vec3 &p = vertices[static_cast<std::size_t>(std::min(a, b))],
               &q = vertices[static_cast<std::size_t>(std::max(a, b))];
    const bool side = (q.x() - p.x()) * (y - p.y()) - (q.y() - p.y()) * (x - p.x()) >= 0;
    return (a < b) == side;
  }

  void cross(double x, double y, std::vector<Crossing>& out, const std::array<int, 3>& t) const {
    const bool side = left(t[0], t[1], x, y);
    if (side != left(t[1], t[2], x, y) || side != left(t[2], t[0], x, y)) return;
    const Vec3 &a = vertices[static_cast<std::size_t>(t[0])], &b = vertices[static_cast<std::size_t>(t[1])],
               &c = vertices[static_cast<std::size_t>(t[2])];
    const Vec3 normal = (b - a).cross(c - a);
    if (normal.z() == 0) return;
    out.push_back({a.z() - (normal.x() * (x - a.x()) + normal.y() * (y - a.y())) / normal.z(), side ? -1 : 1});
  }
};

}  // namespace

MassProperties ray_union(std::span<const Part> parts, int rays) {
  // Oblique to the axes of the frame: no flat face of a usual part is parallel to the rays, so that the length covered
  // varies continuously across the grid and the error falls as the square of the spacing.
  const Mat3 frame = Quat(0.83, 0.31, -0.37, 0.27).normalized().toRotationMatrix();  // columns: across, across, along
  Vec3 lower, upper;
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = frame.col(i);
    lower[i] = std::numeric_limits<double>::infinity(), upper[i] = -lower[i];
    for (const Part& part : parts) {
      upper[i] = std::max(upper[i], support(part, axis));
      lower[i] = std::min(lower[i], -support(part, -axis));
    }
  }
  const Vec3 middle = 0.5 * (lower + upper), spacing = (upper - lower) / rays;

  std::vector<RayMesh> meshes(parts.size());
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto* mesh = std::get_if<TriMesh>(&parts[k].primitive);
    if (!mesh) continue;
    meshes[k].triangles = mesh->triangles;
    for (const Vec3& v : mesh->vertices)
      meshes[k].vertices.push_back(frame.transpose() * parts[k].pose.to_world(v) - middle);
  }

  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  std::vector<std::vector<Crossing>> row(static_cast<std::size_t>(rays));
  const auto coordinate = [&](int index, int axis) { return (index + 0.5 - 0.5 * rays) * spacing[axis]; };
  for (int j = 0; j < rays; ++j) {
    const double y = coordinate(j, 1);
    for (auto& crossings : row) crossings.clear();
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const Vec3 along = parts[k].pose.orientation.conjugate() * frame.col(2);
      for (int i = 0; i < rays && meshes[k].triangles.empty(); ++i) {
        const Vec3 start = parts[k].pose.to_local(frame * (middle + Vec3(coordinate(i, 0), y, 0)));
        const Chord c = chord(parts[k].primitive, start, along);
        if (c.first >= c.second) continue;
        row[static_cast<std::size_t>(i)].push_back({c.first, 1});
        row[static_cast<std::size_t>(i)].push_back({c.second, -1});
      }
      for (const auto& t : meshes[k].triangles) {
        Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
        for (int v : t) {
          low = low.cwiseMin(meshes[k].vertices[static_cast<std::size_t>(v)]);
          high = high.cwiseMax(meshes[k].vertices[static_cast<std::size_t>(v)]);
        }
        if (y < low.y() || y > high.y()) continue;
        const int from = std::max(0, static_cast<int>(std::floor(low.x() / spacing.x() + 0.5 * rays)) - 1);
        const int to = std::min(rays - 1, static_cast<int>(std::floor(high.x() / spacing.x() + 0.5 * rays)) + 1);
        for (int i = from; i <= to; ++i) meshes[k].cross(coordinate(i, 0), y, row[static_cast<std::size_t>(i)], t);
      }
    }
    for (int i = 0; i < rays; ++i) {
      auto& crossings = row[static_cast<std::size_t>(i)];
      std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) { return a.at < b.at; });
      int depth = 0;
      double from = 0;
      for (const Crossing& c : crossings) {
        if (depth == 0) from = c.at;
        depth += c.depth;
        if (depth != 0) continue;
        const double length = c.at - from, centre = 0.5 * (c.at + from);
        const Vec3 p(coordinate(i, 0), y, centre);
        volume += length;
        first += length * p;
        second += length * p * p.transpose();
        second(2, 2) += length * length * length / 12;
      }
    }
  }
  const double cell = spacing.x() * spacing.y();
  const Vec3 centre = first / volume;
  const Mat3 central = cell * (second - volume * centre * centre.transpose());
  return {cell * volume, frame * (middle + centre), inertia_of(frame * central * frame.transpose())};
}

}  // namespace repose
