#pragma once
/// The bodies of a DVI world as arrays in the world's own units: what never changes of them, and their state. A step asks little of
/// each of many bodies, and the bodies of a Model lie hundreds of bytes apart.
#include <cstdint>
#include <vector>

#include "backends/dvi/units.hpp"
#include "core/model.hpp"

namespace repose::dvi {

struct WorldBodies {
  WorldBodies(const Model& model, const Units& units);

  std::size_t count() const { return mass.size(); }

  void load(const Snapshot& state);
  void read(Snapshot& state, int threads) const;

  /// R* of a pair.
  double arm_of(std::size_t a, std::size_t b) const { return reduced_radius(radius[a], radius[b]) / units.length; }

  /// Turns a body by a rotation vector; its angular momentum stays what it was.
  void turn(std::size_t body, const Vec3& by);
  /// The rate at which a body with this angular momentum turns once it has turned by `turn`.
  Vec3 spin_after(std::size_t body, const Vec3& turn) const;

  Units units;
  std::vector<double> mass;             ///< 0 if not dynamic
  std::vector<Vec3> inertia;            ///< principal moments
  std::vector<double> bound;            ///< radius of a ball about the position
  std::vector<double> radius;           ///< Body::radius, which may be infinite [m]
  std::vector<std::int32_t> material;
  std::vector<char> dynamic, isotropic;
  std::vector<std::int32_t> prescribed; ///< those that are not dynamic, ascending
  std::vector<std::int32_t> gated;      ///< those that exist at some times only, ascending

  double time = 0;  ///< [s]
  std::vector<Vec3> position, velocity, angular;
  std::vector<Quat> orientation;
};

}  // namespace repose::dvi
