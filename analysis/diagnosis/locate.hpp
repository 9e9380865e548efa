#pragma once
/// Where the mismatch is: an unknown, piecewise constant force on each body, tested on the likelihood of the whole record. In an impact of a body that is
/// seen to turn a torque is tested beside it.
#include <string>
#include <vector>

#include "analysis/diagnosis/nuisance.hpp"
#include "analysis/diagnosis/segments.hpp"

namespace repose::diagnosis {

struct Located {
  std::size_t run = 0;      ///< of the problem
  std::string observable;   ///< that shows it best
  Segment segment;
  double mass = 0;          ///< of the body [kg]
  Vec3 force = Vec3::Zero();     ///< unknown force, all segments of the run estimated together [N]; 0 where it cannot be seen
  Vec3 force_se = Vec3::Zero();
  double deviate = 0;       ///< of a force (impacts: or a wrench) on the body in this segment, or of the impulse of the contact in which it is hit (probe.hpp)
  double strength = 0;   ///< the same on a scale on which one direction and six compare (probe.hpp); of a stretch, that of one force or drag along all of it
  double p = 1;             ///< corrected for all segments of all runs
};

struct Places {
  std::vector<Located> pieces;     ///< every segment by itself, sorted by p, then by strength
  /// Windows of one run, body and phase each, disjoint within these: those through which one force stands out most, constant, or against the motion and
  /// constant or as its square, so that what acts all along a phase is told as one. They reach across impacts. Of those that stand out alike, the longest.
  /// The force is the mean over its time in the phase, p the smallest of its pieces. An impact is wider by one sample on either side, since it is seen no
  /// more exactly; of two bodies that are hit at once the equal and opposite impulse is tested, too. Sorted as above.
  std::vector<Located> stretches;
};

/// Tests every segment of the given runs of the fit (at most `max_runs`).
Places locate(const Problem& problem, const Fit& nominal, const Nuisance& nuisance, std::size_t max_runs, int replicas, std::uint64_t seed);

}  // namespace repose::diagnosis
