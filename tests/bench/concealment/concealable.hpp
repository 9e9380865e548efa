#pragma once
/// The effects that experiments conceal, each with the range of strengths from invisible to plain.
#include "tests/bench/concealment/experiment.hpp"

namespace repose::concealment {

/// One number at a scene key; strength: its distance from `null`.
Concealable number(const std::string& effect, const std::string& key, double null, double lower, double upper, bool either_sign = false,
                   const std::string& phase = "");
/// A key of the law of a pair that the nominal scene lacks; strength: its value.
Concealable pair_law(const std::string& effect, const std::string& pair, double lower, double upper, const std::string& phase = "");
/// A factor in ln: null 1, strength ln(factor).
Concealable factor(const std::string& effect, const std::string& key, double lower, double upper, const std::string& phase = "");

Concealable quadratic_drag(double lower, double upper, const std::string& phase = "");
Concealable linear_drag(double lower, double upper);
Concealable magnus(double lower, double upper);
/// Along a drawn direction in the plane of `axes` ("xy", "xyz"); strength [N].
Concealable uniform_force(Random& random, const std::string& axes, double lower, double upper);
/// About a drawn horizontal axis; strength [deg].
Concealable gravity_tilt(Random& random, double lower, double upper);
/// Along x, at a drawn frequency and phase; strength [m/s^2].
Concealable periodic_force(Random& random, double lower, double upper);
/// At a drawn frequency and phase; strength [m].
Concealable base_vibration(Random& random, double lower, double upper);
/// At a drawn direction; strength |ln ratio|.
Concealable anisotropic_friction(Random& random, double lower, double upper);

Concealable length_scale();
Concealable time_scale();
Concealable time_offset();
Concealable frame_tilt(Random& random);
Concealable sensor_bias(double lower, double upper);
/// The same of positions, along a drawn horizontal direction; strength [m].
Concealable shifted_origin(Random& random, double lower, double upper);

}  // namespace repose::concealment
