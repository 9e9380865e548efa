#include "backends/dvi/world_dvi_bodies.hpp"

#include "backends/dvi/team.hpp"
#include "backends/dvi/tumbling.hpp"

namespace repose::dvi {

WorldBodies::WorldBodies(const Model& model, const Units& own) : units(own) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    mass.push_back(body.mass / units.mass);
    inertia.push_back(body.inertia / (units.mass * units.length * units.length));
    bound.push_back(model.shapes[static_cast<std::size_t>(body.shape)].bounding_radius * body.scale / units.length);
    radius.push_back(body.radius);
    material.push_back(body.material);
    dynamic.push_back(body.dynamic);
    isotropic.push_back(body.inertia.x() == body.inertia.y() && body.inertia.y() == body.inertia.z());
    if (!body.dynamic) prescribed.push_back(static_cast<std::int32_t>(i));
    if (!body.active.empty()) gated.push_back(static_cast<std::int32_t>(i));
  }
  load(model.initial);
}

void WorldBodies::load(const Snapshot& state) {
  const std::size_t n = count();
  time = state.time;
  position.resize(n);
  velocity.resize(n);
  angular.resize(n);
  orientation = state.orientation;
  for (std::size_t i = 0; i < n; ++i) {
    position[i] = state.position[i] / units.length;
    velocity[i] = state.velocity[i] / units.velocity();
    angular[i] = state.angular_velocity[i] * units.time;
  }
}

void WorldBodies::read(Snapshot& state, int threads) const {
  for (const std::size_t size : {state.position.size(), state.orientation.size(), state.velocity.size(), state.angular_velocity.size()})
    if (size != count()) state.resize(count());
  state.time = time;
  for_each_index(threads, count(), [&](std::size_t i) {
    state.position[i] = position[i] * units.length;
    state.orientation[i] = orientation[i];
    state.velocity[i] = velocity[i] * units.velocity();
    state.angular_velocity[i] = angular[i] / units.time;
  });
}

void WorldBodies::turn(std::size_t body, const Vec3& by) {
  if (by.squaredNorm() == 0) return;
  const Quat before = orientation[body];
  orientation[body] = (rotation_of(by) * before).normalized();
  if (!isotropic[body]) angular[body] = carried_spin(inertia[body], before, orientation[body], angular[body]);
}

Vec3 WorldBodies::spin_after(std::size_t body, const Vec3& turn) const {
  if (isotropic[body]) return angular[body];
  return carried_spin(inertia[body], orientation[body], rotation_of(turn) * orientation[body], angular[body]);
}

}  // namespace repose::dvi
