#pragma once
/// The bodies of a model in the world's own units (backends/dvi/units.hpp), and all that moves them but contacts: loads,
/// prescribed motion, flight.
#include <vector>

#include "backends/dvi/units.hpp"
#include "core/model.hpp"

namespace repose::bullet {

class Bodies {
 public:
  /// The model must outlive the bodies.
  Bodies(const Model& model, const dvi::Units& units);

  std::size_t size() const { return model_.bodies.size(); }
  const Model& model() const { return model_; }
  const dvi::Units& units() const { return units_; }

  void load(const Snapshot& state);
  void read(Snapshot& state) const;

  /// Prescribed bodies take the pose of the present time, and the twist that carries them to the end of a step of `dt` [s].
  void place_prescribed(double dt);
  /// Fills free_velocity, free_spin, mass_with_drag, inertia_with_drag: v_free = (m v + h f) / (m + h damping), and likewise
  /// for each principal axis. `h`: the step in own units. Throws Error (Kind::simulation) if a number is not finite.
  void apply(const BodyLoads& loads, double h);
  /// Symplectic Euler with the present velocities; prescribed bodies stand where they were prescribed to be at the end.
  /// Throws Error (Kind::simulation) if a velocity is not finite.
  void advance(double h);
  /// Turns a body by a rotation vector. Its angular velocity changes so that its angular momentum does not (Bullet's own
  /// gyroscopic terms are off).
  void turn(std::size_t body, const Vec3& rotation_vector);

  double time = 0;  ///< [s]

  // State; arrays by body.
  std::vector<Vec3> position, velocity, spin;
  std::vector<Quat> orientation;
  std::vector<Mat3> rotation;  ///< of `orientation`, at the start of the step

  // Of the step, without contacts.
  std::vector<Vec3> free_velocity, free_spin;
  std::vector<double> mass_with_drag;     ///< m + h damping; 0 if not dynamic
  std::vector<Vec3> inertia_with_drag;    ///< principal; 0 if not dynamic

 private:
  [[noreturn]] void fail(std::size_t body) const;

  const Model& model_;
  dvi::Units units_;
  std::vector<double> mass_;
  std::vector<Vec3> inertia_;
};

}  // namespace repose::bullet
