#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/overloaded.hpp"
#include "core/union_integrals.hpp"

namespace repose {
namespace {

// The squared section radius q(s) = c0 + c1 s + c2 s^2 for from <= s <= to: every primitive of revolution is made of
// such pieces, so that all integrands are polynomials.
struct Piece {
  double from, to, c0, c1, c2;
  double operator()(double s) const { return c0 + s * (c1 + s * c2); }
};

struct Profile {
  Vec3 axis = Vec3::UnitX();
  bool ball = false;  // any axis will do
  std::vector<Piece> pieces;
};

Piece ball_piece(double from, double to, double centre, double radius) {
  return {from, to, radius * radius - centre * centre, 2 * centre, -1};
}

// Radius r0 at `from`, r1 at `to`, linear between.
Piece cone_piece(double from, double to, double r0, double r1) {
  const double k = (r1 - r0) / (to - from), r = r0 - k * from;
  return {from, to, r * r, 2 * r * k, k * k};
}

std::optional<Profile> profile_of(const Primitive& primitive) {
  using Result = std::optional<Profile>;
  return std::visit(
      Overloaded{
          [](const Sphere& s) -> Result {
            return Profile{Vec3::UnitX(), true, {ball_piece(-s.radius, s.radius, 0, s.radius)}};
          },
          [](const Ellipsoid& e) -> Result {
            const Vec3& a = e.semi_axes;
            for (int i = 0; i < 3; ++i) {
              const double across = a[(i + 1) % 3];
              if (across != a[(i + 2) % 3]) continue;
              const double slope = across / a[i];
              return Profile{Vec3::Unit(i), a[i] == across, {{-a[i], a[i], across * across, 0, -slope * slope}}};
            }
            return std::nullopt;
          },
          [](const RoundCone& c) -> Result {
            const double sine = (c.radius_a - c.radius_b) / c.length, cosine = std::sqrt((1 - sine) * (1 + sine));
            const double a = c.radius_a * sine, b = c.length + c.radius_b * sine;  // where the cone touches the spheres
            return Profile{
                Vec3::UnitX(),
                false,
                {ball_piece(-c.radius_a, a, 0, c.radius_a), cone_piece(a, b, c.radius_a * cosine, c.radius_b * cosine),
                 ball_piece(b, c.length + c.radius_b, c.length, c.radius_b)}};
          },
          [](const Cone& c) -> Result {
            return Profile{Vec3::UnitZ(), false, {cone_piece(0, c.height, c.radius, 0)}};
          },
          [](const Cylinder& c) -> Result {
            return Profile{Vec3::UnitZ(), false, {cone_piece(-c.half_height, c.half_height, c.radius, c.radius)}};
          },
          [](const Box&) -> Result { return std::nullopt; },
          [](const HalfSpace&) -> Result { return std::nullopt; },
          [](const Revolved&) -> Result { return std::nullopt; },
          [](const TriMesh&) -> Result { return std::nullopt; },
      },
      primitive);
}

// q(s) with s = sign (x - offset), as a piece along x.
Piece moved(const Piece& p, double sign, double offset) {
  const double a = sign > 0 ? p.from : -p.to, b = sign > 0 ? p.to : -p.from;
  const double c1 = sign * p.c1;
  return {a + offset, b + offset, p.c0 - c1 * offset + p.c2 * offset * offset, c1 - 2 * p.c2 * offset, p.c2};
}

void add_crossings(const Piece& p, const Piece& q, std::vector<double>& breaks) {
  const double a = p.c2 - q.c2, b = 0.5 * (p.c1 - q.c1), c = p.c0 - q.c0;
  const double lower = std::max(p.from, q.from), upper = std::min(p.to, q.to);
  const auto add = [&](double x) {
    if (x > lower && x < upper) breaks.push_back(x);
  };
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return;
  const double root = -(b + std::copysign(std::sqrt(discriminant), b));
  if (a != 0) add(root / a);
  if (root != 0) add(c / root);
}

// x relative to the middle of the body: the moments then lose no digits.
MassProperties integrate(const std::vector<Piece>& pieces, const Vec3& origin, const Vec3& axis) {
  std::vector<double> breaks;
  for (const Piece& p : pieces) breaks.insert(breaks.end(), {p.from, p.to});
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (std::size_t j = i + 1; j < pieces.size(); ++j) add_crossings(pieces[i], pieces[j], breaks);
  std::sort(breaks.begin(), breaks.end());

  // Three Gauss points are exact up to degree five; r^4 and r^2 x^2 have degree four.
  static constexpr std::array<double, 3> weights{5.0 / 18, 8.0 / 18, 5.0 / 18};
  const std::array<double, 3> nodes{0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)};
  double m0 = 0, m1 = 0, m2 = 0, fourth = 0;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const double from = breaks[i], width = breaks[i + 1] - from, middle = from + 0.5 * width;
    const Piece* widest = nullptr;
    for (const Piece& p : pieces)
      if (p.from <= middle && middle <= p.to && (!widest || p(middle) > (*widest)(middle))) widest = &p;
    if (!widest || !(width > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = from + nodes[k] * width, q = std::max(0.0, (*widest)(x));
      const double area = std::numbers::pi * q * weights[k] * width;
      m0 += area;
      m1 += area * x;
      m2 += area * x * x;
      fourth += area * q;
    }
  }
  const double centre = m1 / m0, along = 0.5 * fourth, across = 0.25 * fourth + m2 - m1 * centre;
  return {m0, origin + centre * axis, across * Mat3::Identity() + (along - across) * axis * axis.transpose()};
}

}  // namespace

std::optional<MassProperties> coaxial_union(std::span<const Part> parts) {
  std::vector<Profile> profiles;
  double size = 0;
  for (const Part& part : parts) {
    std::optional<Profile> profile = profile_of(part.primitive);
    if (!profile) return std::nullopt;
    profile->axis = part.pose.orientation * profile->axis;
    profiles.push_back(std::move(*profile));
    size = std::max(size, bounding_radius(part.primitive));
  }
  if (parts.empty()) return std::nullopt;

  // The axis is that of any part that has one; balls alone take the line through the first and the one farthest from
  // it.
  Vec3 point = parts[0].pose.position, axis = Vec3::UnitX();
  double farthest = 0;
  for (const Part& part : parts) {
    const Vec3 offset = part.pose.position - point;
    if (offset.norm() > farthest) axis = offset / (farthest = offset.norm());
  }
  for (std::size_t i = parts.size(); i-- > 0;) {
    if (profiles[i].ball) continue;
    point = parts[i].pose.position;
    axis = profiles[i].axis;
  }

  const double tolerance = 1e-9 * std::max(size, farthest);
  std::vector<Piece> pieces;
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  const auto each_piece = [&](double shift, auto&& action) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const double sign = profiles[i].ball || profiles[i].axis.dot(axis) > 0 ? 1 : -1;
      const double offset = (parts[i].pose.position - point).dot(axis) - shift;
      for (const Piece& piece : profiles[i].pieces) action(moved(piece, sign, offset));
    }
  };
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Vec3 offset = parts[i].pose.position - point;
    if ((offset - offset.dot(axis) * axis).norm() > tolerance) return std::nullopt;
    if (!profiles[i].ball && profiles[i].axis.cross(axis).norm() > 1e-9) return std::nullopt;
  }
  each_piece(0, [&](const Piece& p) {
    lower = std::min(lower, p.from);
    upper = std::max(upper, p.to);
  });
  const double middle = 0.5 * (lower + upper);
  each_piece(middle, [&](const Piece& p) { pieces.push_back(p); });
  return integrate(pieces, point + middle * axis, axis);
}

}  // namespace repose
