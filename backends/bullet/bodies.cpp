#include "backends/bullet/bodies.hpp"

#include "core/error.hpp"

namespace repose::bullet {

Bodies::Bodies(const Model& model, const dvi::Units& units) : model_(model), units_(units) {
  for (const Body& body : model.bodies) {
    mass_.push_back(body.mass / units.mass);
    inertia_.push_back(body.inertia / (units.mass * units.length * units.length));
  }
  load(model.initial);
}

void Bodies::load(const Snapshot& state) {
  const std::size_t n = state.size();
  time = state.time;
  orientation = state.orientation;
  position.resize(n);
  velocity.resize(n);
  spin.resize(n);
  rotation.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    position[i] = state.position[i] / units_.length;
    velocity[i] = state.velocity[i] / units_.velocity();
    spin[i] = state.angular_velocity[i] * units_.time;
  }
}

void Bodies::read(Snapshot& state) const {
  state.resize(size());
  state.time = time;
  for (std::size_t i = 0; i < size(); ++i) {
    state.position[i] = position[i] * units_.length;
    state.orientation[i] = orientation[i];
    state.velocity[i] = velocity[i] * units_.velocity();
    state.angular_velocity[i] = spin[i] / units_.time;
  }
}

void Bodies::place_prescribed(double dt) {
  for (std::size_t i = 0; i < size(); ++i) {
    const Body& body = model_.bodies[i];
    if (body.dynamic) continue;
    const Pose initial{model_.initial.position[i], model_.initial.orientation[i]};
    const Pose pose = pose_at(body.motion, initial, time);
    const Twist twist = mean_twist(body.motion, initial, time, dt);
    position[i] = pose.position / units_.length;
    orientation[i] = pose.orientation;
    velocity[i] = twist.linear / units_.velocity();
    spin[i] = twist.angular * units_.time;
  }
}

void Bodies::apply(const BodyLoads& loads, double h) {
  const double inertia_unit = units_.mass * units_.length * units_.length;
  free_velocity = velocity;
  free_spin = spin;
  mass_with_drag.assign(size(), 0);
  inertia_with_drag.assign(size(), Vec3::Zero());
  for (std::size_t i = 0; i < size(); ++i) {
    rotation[i] = orientation[i].toRotationMatrix();
    if (!model_.bodies[i].dynamic) continue;
    mass_with_drag[i] = mass_[i] + h * loads.linear_damping[i] / (units_.mass / units_.time);
    free_velocity[i] = (mass_[i] * velocity[i] + h * (loads.force[i] / units_.force())) / mass_with_drag[i];
    inertia_with_drag[i] = inertia_[i].array() + h * (loads.angular_damping[i] / (inertia_unit / units_.time));
    const Vec3 momentum = inertia_[i].cwiseProduct(rotation[i].transpose() * spin[i]) +
                          rotation[i].transpose() * Vec3(h * (loads.torque[i] / (units_.force() * units_.length)));
    free_spin[i] = rotation[i] * momentum.cwiseQuotient(inertia_with_drag[i]);
    if (!position[i].allFinite() || !free_velocity[i].allFinite() || !free_spin[i].allFinite()) fail(i);
  }
}

void Bodies::advance(double h) {
  for (std::size_t i = 0; i < size(); ++i) {
    if (model_.bodies[i].dynamic) {
      if (!velocity[i].allFinite() || !spin[i].allFinite()) fail(i);
      position[i] += h * velocity[i];
      turn(i, h * spin[i]);
    } else {
      const Pose initial{model_.initial.position[i], model_.initial.orientation[i]};
      const Pose pose = pose_at(model_.bodies[i].motion, initial, time + h * units_.time);
      position[i] = pose.position / units_.length;
      orientation[i] = pose.orientation;
    }
  }
}

void Bodies::turn(std::size_t i, const Vec3& rotation_vector) {
  if (rotation_vector.squaredNorm() == 0) return;
  const Mat3 before = orientation[i].toRotationMatrix();
  orientation[i] = (rotation_of(rotation_vector) * orientation[i]).normalized();
  if (inertia_[i].x() == inertia_[i].y() && inertia_[i].y() == inertia_[i].z()) return;
  const Mat3 after = orientation[i].toRotationMatrix();
  const Vec3 momentum = before * inertia_[i].cwiseProduct(before.transpose() * spin[i]);
  spin[i] = after * (after.transpose() * momentum).cwiseQuotient(inertia_[i]);
}

void Bodies::fail(std::size_t body) const {
  throw Error("body " + std::to_string(body),
              "its velocity is not a finite number at t = " + std::to_string(time) + " s",
              "this is a failure of the simulation: try a smaller time_step, and look for bodies pressed together by tools",
              Error::Kind::simulation);
}

}  // namespace repose::bullet
