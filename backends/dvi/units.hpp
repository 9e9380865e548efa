#pragma once
/// The world's own units of length, mass and time, in which a grain is of the order of one.
///
/// All three are powers of two, so that changing units is exact, and follow the sizes of the bodies: a model scaled by an
/// even power of two in length (and its root in time) is the same model, bit for bit, in these units.
#include "core/model.hpp"

namespace repose::dvi {

struct Units {
  double length = 1;  ///< [m]
  double mass = 1;    ///< [kg]
  double time = 1;    ///< [s]; about sqrt(length / gravity on Earth)

  double velocity() const { return length / time; }
  double force() const { return mass * length / (time * time); }
  double impulse() const { return mass * length / time; }
  double energy() const { return mass * length * length / (time * time); }
};

/// From the mean radius and mean mass of the dynamic bodies.
Units units_of(const Model& model);

}  // namespace repose::dvi
