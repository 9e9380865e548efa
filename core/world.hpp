#pragma once
/// The interface of a backend: a world that steps, tells its state and contacts, and can be saved and restored.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/model.hpp"

namespace repose {

/// What happened in one step; also the record of how far the solver got. Non-convergence is data, never hidden.
struct StepReport {
  int contacts = 0;          ///< contact points in the problem
  int iterations = 0;        ///< of the solver, all passes together
  double residual = 0;       ///< relative, of the exact law (see backends/dvi/cone_problem.hpp); 0 if not defined
  bool converged = true;     ///< residual <= tolerance
  bool cycling = false;      ///< the solver's fixed point was seen to cycle and its fallback rule was used
  double penetration = 0;    ///< deepest overlap at the start of the step, which the one before left, by geometry [m], >= 0
  double contact_work = 0;   ///< work of all contact impulses of this step [J]; <= 0 up to rounding when no tool moves
  double left = 0;           ///< [s] of the time asked for that is still to be stepped: the step ended at a touch
};

/// One contact point with the force that acted during the last step.
struct Contact {
  int a = -1, b = -1;                  ///< bodies, a < b
  Vec3 point = Vec3::Zero();           ///< [m], world; in a periodic cell beside a, where b's nearest image touches it
  Vec3 normal = Vec3::UnitZ();         ///< unit, from a to b, world
  double gap = 0;                      ///< [m], > 0 apart
  Vec3 force = Vec3::Zero();           ///< on b [N], world (impulse / step)
  Vec3 torque = Vec3::Zero();          ///< rolling and spinning resistance on b [N m], world
};

/// The complete state of a world: what a checkpoint holds. `arrays` is the backend's own (impulses for the warm start,
/// contact ids, orderings); only the backend that wrote it can read it.
struct Frame {
  std::int64_t step = 0;
  Snapshot state;
  std::map<std::string, std::vector<double>> numbers;
  std::map<std::string, std::vector<std::int64_t>> integers;
};

class World {
 public:
  virtual ~World() = default;
  /// Advances by dt [s] under the loads, or by less: StepReport::left. Throws Error (Kind::simulation) if the state stops being finite.
  virtual StepReport step(double dt, const BodyLoads& loads) = 0;
  virtual void read(Snapshot& state) const = 0;
  /// Contact points of the last step, in a fixed order; those without force included.
  virtual void read(std::vector<Contact>& contacts) const = 0;
  /// The same of the bodies listed (ascending) alone; a backend may spare itself the others.
  virtual void read_at(std::span<const int> bodies, std::vector<Contact>& contacts) const {
    read(contacts);
    std::erase_if(contacts, [&](const Contact& c) {
      return !std::binary_search(bodies.begin(), bodies.end(), c.a) && !std::binary_search(bodies.begin(), bodies.end(), c.b);
    });
  }
  virtual void save(Frame& frame) const = 0;
  /// Continues from `frame` bit for bit (if the backend can: DVI does). Throws Error if it does not fit the model.
  virtual void restore(const Frame& frame) = 0;
};

enum class SolverKind : std::uint8_t { gauss_seidel, apgd, barzilai_borwein };
enum class ContactLaw : std::uint8_t { exact, relaxed };

/// Symplectic Euler is for powder: its error is of the order of the step, in v_0 + a h / 2 instead of v_0 and in the time of every
/// blow. Second order is for few bodies: flight and sliding by mean velocities, friction along the mean slip, and steps that end where bodies touch.
enum class Integration : std::uint8_t { symplectic_euler, second_order };

struct SolverOptions {
  double time_step = 1e-4;     ///< h [s], > 0
  double tolerance = 1e-3;     ///< on the relative residual, > 0
  int max_iterations = 1000;   ///< > 0, per step
  SolverKind kind = SolverKind::gauss_seidel;  ///< which of DVI's methods; other engines have one of their own
  ContactLaw law = ContactLaw::exact;
  Integration integration = Integration::symplectic_euler;
  bool warm_start = true;
  int threads = 1;             ///< >= 1; never changes the result
  double search_margin = 1;    ///< >= 1, multiplies the contact search distance; must not change results
  bool operator==(const SolverOptions&) const = default;
};

/// One row of the table of backends (backends/backends.hpp).
struct Backend {
  std::string name;
  std::string summary;
  /// Physics of the model that this backend cannot do, by scene key; empty if all can be done.
  std::vector<std::string> (*unsupported)(const Model&);
  std::unique_ptr<World> (*make)(const Model&, const SolverOptions&);
  bool has_tolerance = true;  ///< false: SolverOptions::tolerance changes nothing (a direct solver)
  bool has_second_order = false;  ///< knows Integration::second_order; if not, make() refuses it
  std::size_t most_grains = std::numeric_limits<std::size_t>::max();  ///< beyond these a step takes seconds: it is asked only where it is named
};

}  // namespace repose
