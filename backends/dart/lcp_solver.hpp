#pragma once
/// Solves the contact problem of one step with DART: its rigid bodies, its islands, its boxed complementarity problem.
///
/// The law: u_n + bias >= 0, g_n + cohesion = p >= 0, one of the two zero; each of the two sliding rows bounded on its
/// own, |g_t1| <= mu p and |g_t2| <= mu p, opposing the slip unless it stops (a pyramid, not a cone; its first edge
/// lies along the slip that there would be without contacts, so friction that opposes it is exact, and sticking
/// friction may reach sqrt(2) mu p); likewise the two rolling rows with rho and the spinning row with sigma.
#include <memory>
#include <span>
#include <vector>

#include "backends/dvi/cone_problem.hpp"

namespace repose::dart {

/// On b, in world axes.
struct ContactImpulse {
  Vec3 force = Vec3::Zero();   ///< [impulse]
  Vec3 couple = Vec3::Zero();  ///< [impulse times length]
};

struct LcpSolverReport {
  int iterations = 0;   ///< passes of the island that took most: boxed_lcp.hpp
  double residual = 0;  ///< of the worst island: boxed_lcp.hpp
  bool converged = true;
  bool swept = false;
};

class LcpSolver {
 public:
  explicit LcpSolver(std::size_t dynamic_bodies);
  ~LcpSolver();

  /// `problem`: with as many dynamic bodies as above. Out: one impulse per contact, and the velocities of all bodies.
  LcpSolverReport solve(const dvi::ConeProblem& problem, double tolerance, int max_passes,
                        std::vector<ContactImpulse>& impulse, std::vector<Vec3>& velocity,
                        std::vector<Vec3>& angular_velocity);

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
};

}  // namespace repose::dart
