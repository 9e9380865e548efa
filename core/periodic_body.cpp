#include "core/periodic_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/overloaded.hpp"

namespace repose {
namespace {

constexpr double parallel = 1e-9;  // sine of the angle by which a tool may miss an axis

const char* axis_name(int axis) { return axis == 0 ? "x" : axis == 1 ? "y" : "z"; }

double bound(const Model& model, const Body& body) {
  return body.scale * model.shapes[static_cast<std::size_t>(body.shape)].bounding_radius;
}

/// D of the header [m]; 0 if nothing moves.
double largest_moving(const Model& model) {
  double radius = 0, range = 0;
  for (const Body& body : model.bodies)
    if (body.dynamic) radius = std::max(radius, bound(model, body));
  for (const PairLaw& law : model.laws)
    if (law.cohesion > 0) range = std::max(range, law.cohesion_range);
  return radius > 0 ? 2 * radius + range : 0;
}

std::string place_of(const Model& model, const Body& body) {
  const char* block = body.role == BodyRole::grain ? "grains" : body.role == BodyRole::tool ? "tools" : "bodies";
  return body.name < 0 ? std::string(block) : fmt::format("{}.{}", block, model.names[static_cast<std::size_t>(body.name)]);
}

bool is_parallel(const Vec3& direction, int axis) {
  Vec3 across = direction;
  across[axis] = 0;
  return across.norm() <= parallel * direction.norm();
}

/// Whether a solid that is the same everywhere along the axis stays so while it moves. A half-space has no ends.
bool keeps_its_place(const Motion& motion, int axis, bool has_ends) {
  if (!is_parallel(motion.angular_velocity, axis)) return false;
  return !has_ends || (motion.velocity[axis] == 0 && motion.vibration_amplitude[axis] == 0);
}

/// A stretch of the axis, seen from a primitive: `axis` is the unit vector in its frame; lengths in its own scale.
struct Stretch {
  Vec3 axis;
  double from, to;
};

bool box_is_endless(const Box& box, const Stretch& stretch) {
  for (int k = 0; k < 3; ++k)
    if (is_parallel(stretch.axis, k)) return box.half_extents[k] >= std::max(stretch.to, -stretch.from);
  return false;
}

/// No end, step or cone of the profile within the stretch, and something there at all.
bool profile_is_endless(const Revolved& solid, const Stretch& stretch) {
  if (!is_parallel(stretch.axis, 2)) return false;
  const double sign = stretch.axis.z() > 0 ? 1 : -1;
  bool there = false;
  for (std::size_t i = 0; i < solid.profile.size(); ++i) {
    const Vec2 &p = solid.profile[i], &q = solid.profile[(i + 1) % solid.profile.size()];
    const double a = sign * p.y(), b = sign * q.y();
    if (std::max(a, b) <= stretch.from || std::min(a, b) >= stretch.to) continue;
    if (p.x() != q.x()) return false;
    there = true;
  }
  return there;
}

bool part_is_endless(const Primitive& primitive, const Stretch& stretch) {
  return std::visit(Overloaded{
                        [&](const HalfSpace& h) { return std::abs(h.normal.dot(stretch.axis)) <= parallel; },
                        [&](const Box& b) { return box_is_endless(b, stretch); },
                        [&](const Cylinder& c) {
                          return is_parallel(stretch.axis, 2) && c.half_height >= std::max(stretch.to, -stretch.from);
                        },
                        [&](const Revolved& r) { return profile_is_endless(r, stretch); },
                        [](const Sphere&) { return false; },
                        [](const Ellipsoid&) { return false; },
                        [](const RoundCone&) { return false; },
                        [](const Cone&) { return false; },
                        [](const TriMesh&) { return false; },
                    },
                    primitive);
}

/// The largest |axis . x| over the points x of a primitive moved by `offset` along the axis.
double farthest(const Primitive& primitive, const Vec3& axis, double offset) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto meet = [&](double middle, double half) {
    low = std::min(low, offset + middle - half);
    high = std::max(high, offset + middle + half);
  };
  const double level = axis.head<2>().norm();  // what a horizontal disc shows of its radius
  std::visit(Overloaded{
                 [&](const Sphere& s) { meet(0, s.radius); },
                 [&](const Ellipsoid& e) { meet(0, e.semi_axes.cwiseProduct(axis).norm()); },
                 [&](const RoundCone& c) {
                   meet(0, c.radius_a);
                   meet(c.length * axis.x(), c.radius_b);
                 },
                 [&](const Cone& c) {
                   meet(0, c.radius * level);
                   meet(c.height * axis.z(), 0);
                 },
                 [&](const Box& b) { meet(0, b.half_extents.dot(axis.cwiseAbs())); },
                 [&](const Cylinder& c) { meet(0, c.half_height * std::abs(axis.z()) + c.radius * level); },
                 [&](const HalfSpace&) { meet(0, std::numeric_limits<double>::infinity()); },
                 [&](const Revolved& r) {
                   for (const Vec2& p : r.profile) meet(p.y() * axis.z(), p.x() * level);
                 },
                 [&](const TriMesh& m) {
                   for (const Vec3& v : m.vertices) meet(v.dot(axis), 0);
                 },
             },
             primitive);
  return std::max(-low, high);
}

/// How far a body reaches from its position along the axis, at all times [m].
double reach_along(const Model& model, std::size_t i, int axis) {
  const Body& body = model.bodies[i];
  if (body.motion.angular_velocity.norm() > 0 && !is_parallel(body.motion.angular_velocity, axis))
    return bound(model, body);
  double reach = 0;
  for (const Part& part : model.shapes[static_cast<std::size_t>(body.shape)].parts) {
    const Vec3 in_body = model.initial.orientation[i].conjugate() * Vec3::Unit(axis);
    const Vec3 in_part = part.pose.orientation.conjugate() * in_body;
    reach = std::max(reach, body.scale * farthest(part.primitive, in_part, in_body.dot(part.pose.position)));
  }
  return reach;
}

bool is_endless(const Model& model, std::size_t i, int axis, double margin) {
  const Body& body = model.bodies[i];
  if (body.dynamic || !model.periodic.along(axis)) return false;
  bool has_ends = false;
  for (const Part& part : model.shapes[static_cast<std::size_t>(body.shape)].parts) {
    const Quat turn = model.initial.orientation[i] * part.pose.orientation;
    const double at = (model.initial.position[i] + model.initial.orientation[i] * (body.scale * part.pose.position))[axis];
    const Stretch stretch{turn.conjugate() * Vec3::Unit(axis), (model.periodic.lower[axis] - margin - at) / body.scale,
                          (model.periodic.upper[axis] + margin - at) / body.scale};
    if (!part_is_endless(part.primitive, stretch)) return false;
    has_ends = has_ends || !std::holds_alternative<HalfSpace>(part.primitive);
  }
  return keeps_its_place(body.motion, axis, has_ends);
}

void check_moving(const Model& model, std::size_t i, int axis) {
  const double x = model.initial.position[i][axis];
  if (x >= model.periodic.lower[axis] && x <= model.periodic.upper[axis]) return;
  throw Error(place_of(model, model.bodies[i]),
              fmt::format("starts at {} = {:.6g} m, outside the periodic cell", axis_name(axis), x),
              "start it in the cell; realise() does");
}

void check_tool(const Model& model, std::size_t i, int axis, double margin) {
  if (is_endless(model, i, axis, margin)) return;
  const PeriodicCell& cell = model.periodic;
  const std::string place = place_of(model, model.bodies[i]);
  const char* name = axis_name(axis);
  const double from = cell.lower[axis] - margin, to = cell.upper[axis] + margin, middle = 0.5 * (from + to);
  const std::string cover = fmt::format(
      "make it a floor, plate, box or roller that lies along {0} and reaches from {0} = {1:.4g} m or below to {2:.4g} m or "
      "above ({3:.4g} m long if centred on {0} = {4:.4g} m), without motion along {0} or turning across it",
      name, from, to, to - from, middle);
  const double reach = reach_along(model, i, axis), allowed = 0.5 * cell.length(axis) - margin;
  if (!(reach <= allowed))
    throw Error(place,
                fmt::format("it is neither the same all along the periodic axis {} nor short enough to be repeated with the "
                            "period: it reaches {:.4g} m from its position, {:.4g} m are possible",
                            name, reach, std::max(allowed, 0.0)),
                cover + ", or make it shorter, or the period longer");
  const double x = model.initial.position[i][axis];
  if (!(x >= cell.lower[axis] && x <= cell.upper[axis]))
    throw Error(place,
                fmt::format("it would be repeated with the period along {}, but stands at {} = {:.4g} m, outside the cell",
                            name, name, x),
                fmt::format("move it to between {:.4g} and {:.4g} m, or leave it out", cell.lower[axis], cell.upper[axis]));
}

}  // namespace

bool is_endless(const Model& model, std::size_t body, int axis) {
  // Asked of every body: only the few that are not free are worth a look at all others.
  return !model.bodies[body].dynamic && model.periodic.along(axis) && is_endless(model, body, axis, largest_moving(model));
}

void check_periodic(const Model& model) {
  const PeriodicCell& cell = model.periodic;
  if (!cell.lower.allFinite() || !cell.upper.allFinite() || (cell.upper - cell.lower).minCoeff() < 0)
    throw Error("periodic", "a bound is not finite or the upper one lies below the lower", "give lower < upper");
  if (!cell.any()) return;
  if (cell.along(2))
    throw Error("periodic.z", "gravity acts along z: what falls out of the cell would fall for ever",
                "only x and y can be periodic");
  const double size = largest_moving(model);
  for (int axis = 0; axis < 2; ++axis) {
    if (!cell.along(axis)) continue;
    if (!(cell.length(axis) >= least_period * size))
      throw Error(fmt::format("periodic.{}", axis_name(axis)),
                  fmt::format("the period of {:.4g} m is below {:g} times the largest moving body (with its range of "
                              "cohesion {:.4g} m): two bodies could meet on both sides at once",
                              cell.length(axis), least_period, size),
                  fmt::format("make it {:.4g} m or longer, or the bodies smaller", least_period * size));
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
      if (model.bodies[i].dynamic)
        check_moving(model, i, axis);
      else
        check_tool(model, i, axis, size);
    }
  }
}

}  // namespace repose
