#pragma once
/// Where the mismatch is: an unknown, piecewise constant wrench on each body, tested on the likelihood of the whole record.
#include <string>
#include <vector>

#include "analysis/diagnosis/screen.hpp"

namespace repose::diagnosis {

enum class Phase { flight, impact, sliding, rolling, rest };
const std::string& phase_name(Phase phase);

/// The phase of a body at each step. No contact force: flight. Approach faster than what one step of gravity gives: impact.
/// Contact and slower than 1 % of sqrt(g R) (and turning slower than that over R): rest. Slip slower than 5 % of the speed: rolling.
std::vector<Phase> phases_of(const History& history, const BodyTrack& track, double radius);

/// A stretch of one body's path in one phase.
struct Segment {
  std::string body;
  Phase phase = Phase::flight;
  double from = 0, to = 0;  ///< [s]
  double speed = 0, slip_speed = 0, spin = 0, normal_force = 0, height = 0, time = 0;  ///< means
  Vec3 velocity = Vec3::Zero();
};

/// Parts a path at changes of phase and into at most about `parts` pieces of similar length; impacts last as long as the contact, at
/// least three steps.
std::vector<Segment> segments_of(const History& history, const std::string& body, double until, int parts);

struct Located {
  std::size_t run = 0;      ///< of the problem
  std::string observable;   ///< that shows it best
  Segment segment;
  double mass = 0;          ///< of the body [kg]
  Vec3 force = Vec3::Zero();     ///< unknown force, all segments of the run estimated together [N]; 0 where it cannot be seen
  Vec3 force_se = Vec3::Zero();
  double gain = 0;          ///< of this segment alone, twice the log likelihood ratio
  double p = 1;             ///< corrected for all segments of all runs
};

/// Tests every segment of the given runs of the fit (at most `max_runs`). Sorted by p, then by gain; neighbouring segments of the same
/// phase that are significant together are one entry.
std::vector<Located> locate(const Problem& problem, const Fit& nominal, const Nuisance& nuisance, int max_runs, int replicas,
                            std::uint64_t seed);

}  // namespace repose::diagnosis
