#pragma once
/// The phases of a body's path, and the stretches between them.
#include <string>
#include <vector>

#include "analysis/history.hpp"

namespace repose::diagnosis {

/// |g| of the history; 9.81 m/s^2 where there is no gravity.
double gravity_scale(const History& history);

enum class Phase { flight, impact, sliding, rolling, rest };
const std::string& phase_name(Phase phase);

/// The phase of a body at each step. No contact force: flight. Approach faster than what one step of gravity gives: impact.
/// Contact and slower than 1 % of sqrt(g R) (and turning slower than that over R): rest. Slip slower than 5 % of the speed: rolling, or, where the
/// body does not turn either, rest on what carries it.
std::vector<Phase> phases_of(const History& history, const BodyTrack& track, double radius);

/// A stretch of one body's path in one phase.
struct Segment {
  std::string body;
  Phase phase = Phase::flight;
  double from = 0, to = 0;  ///< [s]
  double speed = 0, slip_speed = 0, spin = 0, normal_force = 0, height = 0, time = 0;  ///< means
  Vec3 velocity = Vec3::Zero();
};

/// Two that follow one another as one; means are over time.
Segment joined(const Segment& a, const Segment& b);

/// Parts a path at changes of phase and into at most about `parts` pieces of similar length; impacts last as long as the contact, at
/// least three steps.
std::vector<Segment> segments_of(const History& history, const std::string& body, double until, int parts);

}  // namespace repose::diagnosis
