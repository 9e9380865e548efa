#include "backends/bullet/contact_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace repose::bullet {

namespace {

constexpr double resting_margin = 0.02;  // of the radius
constexpr double handed_on = 0.25;       // of a body's way in the step: what a blow within the step may add to a pair
constexpr double infinite = std::numeric_limits<double>::infinity();

struct LocalBox {
  Vec3 centre = Vec3::Zero(), half = Vec3::Zero();
};

LocalBox box_of(const RoundCone& c) {
  const double low = std::min(-c.radius_a, c.length - c.radius_b), high = std::max(c.radius_a, c.length + c.radius_b);
  const double across = std::max(c.radius_a, c.radius_b);
  return {Vec3(0.5 * (low + high), 0, 0), Vec3(0.5 * (high - low), across, across)};
}
LocalBox box_of(const Revolved& solid) {
  double low = infinite, high = -infinite, across = 0;
  for (const Vec2& p : solid.profile) {
    low = std::min(low, p.y());
    high = std::max(high, p.y());
    across = std::max(across, p.x());
  }
  return {Vec3(0, 0, 0.5 * (low + high)), Vec3(across, across, 0.5 * (high - low))};
}
LocalBox box_of(const TriMesh& mesh) {
  Vec3 low = Vec3::Constant(infinite), high = -low;
  for (const Vec3& p : mesh.vertices) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return {0.5 * (low + high), 0.5 * (high - low)};
}
LocalBox box_of(const Sphere& s) { return {Vec3::Zero(), Vec3::Constant(s.radius)}; }
LocalBox box_of(const Ellipsoid& e) { return {Vec3::Zero(), e.semi_axes}; }
LocalBox box_of(const Cone& c) { return {Vec3(0, 0, 0.5 * c.height), Vec3(c.radius, c.radius, 0.5 * c.height)}; }
LocalBox box_of(const Box& b) { return {Vec3::Zero(), b.half_extents}; }
LocalBox box_of(const Cylinder& c) { return {Vec3::Zero(), Vec3(c.radius, c.radius, c.half_height)}; }
LocalBox box_of(const HalfSpace&) { return {Vec3::Zero(), Vec3::Constant(infinite)}; }

bool is_round(const Primitive& p) { return std::holds_alternative<Sphere>(p) || std::holds_alternative<Ellipsoid>(p); }

std::vector<char> fixed_bodies(const Model& model) {
  std::vector<char> fixed;
  for (const Body& body : model.bodies) fixed.push_back(!body.dynamic);
  return fixed;
}

}  // namespace

ContactSearch::ContactSearch(const Bodies& bodies) : bodies_(bodies), search_(fixed_bodies(bodies.model())) {
  const Model& model = bodies.model();
  first_part_.push_back(0);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    const Shape& shape = model.shapes[static_cast<std::size_t>(body.shape)];
    const double scale = body.scale / bodies.units().length;
    bound_.push_back(shape.bounding_radius * scale);
    radius_.push_back(body.radius / bodies.units().length);
    if (!shape.bounded()) unbounded_.push_back(static_cast<std::int32_t>(i));
    for (const Part& part : shape.parts) {
      const LocalBox box = std::visit([](const auto& p) { return box_of(p); }, part.primitive);
      PlacedPart placed;
      placed.body = i;
      placed.primitive.primitive = &part.primitive;
      placed.primitive.scale = scale;
      placed.convex = convex_shape(part.primitive, scale);
      placed.centre = scale * box.centre;
      placed.half = scale * box.half;
      placed.bound = bounding_radius(part.primitive) * scale;
      parts_.push_back(std::move(placed));
    }
    first_part_.push_back(parts_.size());
  }
  for (const PairLaw& law : model.laws)
    if (law.cohesion > 0) widest_cohesion_ = std::max(widest_cohesion_, law.cohesion_range / bodies.units().length);
}

double ContactSearch::slack(std::size_t body, double h) const {
  const double resting = std::isfinite(radius_[body]) ? resting_margin * radius_[body] : 0;
  return resting + handed_on * h * speed_[body];
}

double ContactSearch::cohesion_range(std::size_t a, std::size_t b) const {
  const PairLaw& law = bodies_.model().law(bodies_.model().bodies[a].material, bodies_.model().bodies[b].material);
  return law.cohesion > 0 ? law.cohesion_range / bodies_.units().length : 0.0;
}

void ContactSearch::place(double h, double margin) {
  const Model& model = bodies_.model();
  const std::size_t n = model.bodies.size();
  present_.resize(n);
  speed_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    present_[i] = model.bodies[i].exists_at(bodies_.time) ? 1 : 0;
    // An unbounded body that turns has no fastest point; near the others it moves like its origin.
    const double turning = std::isfinite(bound_[i]) ? bodies_.free_spin[i].norm() * bound_[i] : 0.0;
    speed_[i] = bodies_.free_velocity[i].norm() + turning;
    const Shape& shape = model.shapes[static_cast<std::size_t>(model.bodies[i].shape)];
    Vec3 low = Vec3::Constant(infinite), high = -low;
    for (std::size_t p = first_part_[i]; p < first_part_[i + 1]; ++p) {
      dvi::PlacedPrimitive& placed = parts_[p].primitive;
      const Pose& pose = shape.parts[p - first_part_[i]].pose;
      placed.position = bodies_.position[i] + bodies_.rotation[i] * (placed.scale * pose.position);
      placed.rotation = bodies_.rotation[i] * pose.orientation.toRotationMatrix();
      const Vec3 centre = placed.position + placed.rotation * parts_[p].centre;
      const Vec3 half = placed.rotation.cwiseAbs() * parts_[p].half;
      low = low.cwiseMin(centre - half);
      high = high.cwiseMax(centre + half);
    }
    if (!shape.bounded()) continue;
    const Vec3 reach = Vec3::Constant(h * speed_[i] + margin * std::max(slack(i, h), 0.5 * widest_cohesion_));
    search_.set_box(static_cast<std::int32_t>(i), low - reach, high + reach);
  }
}

const std::vector<FoundContact>& ContactSearch::find(double h, double margin) {
  place(h, margin);
  found_.clear();
  for (const std::int32_t plane : unbounded_)
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      if (bodies_.model().bodies[i].dynamic) {
        const auto body = static_cast<std::int32_t>(i);
        collide(std::min(plane, body), std::max(plane, body), h, margin);
      }
  for (const auto& [a, b] : search_.pairs()) collide(a, b, h, margin);
  const auto key = [](const FoundContact& c) { return std::tuple(c.a, c.b, c.features); };
  std::sort(found_.begin(), found_.end(), [&](const FoundContact& x, const FoundContact& y) { return key(x) < key(y); });
  return found_;
}

void ContactSearch::collide(std::int32_t a, std::int32_t b, double h, double margin) {
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  if (!present_[i] || !present_[j]) return;
  const double turning = speed_[i] - bodies_.free_velocity[i].norm() + speed_[j] - bodies_.free_velocity[j].norm();
  const double approach = (bodies_.free_velocity[i] - bodies_.free_velocity[j]).norm() + turning;
  const double reach = std::max(h * approach + margin * std::max(slack(i, h), slack(j, h)), cohesion_range(i, j));
  const Model& model = bodies_.model();
  const auto gate_open = [&](const Body& body, double gap) {
    return !body.active.empty() && gap < -body.gate_tolerance / bodies_.units().length;
  };
  for (std::size_t p = first_part_[i]; p < first_part_[i + 1]; ++p)
    for (std::size_t q = first_part_[j]; q < first_part_[j + 1]; ++q) {
      const double far = parts_[p].bound + parts_[q].bound + reach;
      if ((parts_[q].primitive.position - parts_[p].primitive.position).squaredNorm() > far * far) continue;
      scratch_.clear();
      collide(parts_[p], parts_[q], reach);
      const std::uint64_t part_pair = static_cast<std::uint64_t>(p - first_part_[i]) << 48 |
                                      static_cast<std::uint64_t>(q - first_part_[j]) << 32;
      for (const dvi::ContactPoint& point : scratch_)
        if (!gate_open(model.bodies[i], point.gap) && !gate_open(model.bodies[j], point.gap))
          found_.push_back({a, b, part_pair | point.feature, point});
    }
}

void ContactSearch::collide(const PlacedPart& x, const PlacedPart& y, double reach) {
  const Primitive &p = *x.primitive.primitive, &q = *y.primitive.primitive;
  const auto *ball = std::get_if<Sphere>(&p), *other_ball = std::get_if<Sphere>(&q);
  dvi::ContactPoint point;
  if (ball && other_ball) {
    const double radius = ball->radius * x.primitive.scale;
    const Vec3 d = y.primitive.position - x.primitive.position;
    const double distance = d.norm();
    point.normal = distance > 0 ? Vec3(d / distance) : Vec3::UnitZ();
    point.gap = distance - radius - other_ball->radius * y.primitive.scale;
    point.point = x.primitive.position + (radius + 0.5 * point.gap) * point.normal;
    if (point.gap <= reach) scratch_.push_back(point);
    return;
  }
  const bool two_cones = std::holds_alternative<RoundCone>(p) && std::holds_alternative<RoundCone>(q);
  if (x.convex && y.convex && (is_round(p) || is_round(q) || two_cones)) {
    const Touch answer = touch({x.convex.get(), x.primitive.position, x.primitive.rotation},
                               {y.convex.get(), y.primitive.position, y.primitive.rotation}, reach, point);
    if (answer == Touch::found) scratch_.push_back(point);
    if (answer != Touch::no_answer) return;
  }
  dvi::collide(x.primitive, y.primitive, reach, scratch_);
}

}  // namespace repose::bullet
