#include "backends/dvi/cone_solver.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "backends/dvi/gauss_seidel.hpp"
#include "backends/dvi/packed_problem.hpp"
#include "backends/dvi/projected_gradient.hpp"
#include "backends/dvi/residual.hpp"
#include "backends/dvi/slip_law.hpp"

namespace repose::dvi {

namespace {

constexpr std::size_t single_precision_above = 2000;  // contacts
constexpr int stagnation_iterations = 300;
constexpr double stagnation_ratio = 0.98;
constexpr double hopeless = 0.5;
constexpr double negligible = 1e-2;  // of the tolerance
// Momentum pays where impulses are handed through many contacts. A few contacts are solved at once without it.
constexpr std::size_t many_contacts = 100;
constexpr std::size_t worth_a_thread = 1000;  // contacts: fewer are not worth waking one for

/// Watches the best residual; tells when it has stood still for too long.
class StagnationWatch {
 public:
  bool stands_still(double residual, int iterations) {
    if (residual < stagnation_ratio * reference_) {
      reference_ = residual;
      since_ = iterations;
      return false;
    }
    if (iterations - since_ < stagnation_iterations) return false;
    since_ = iterations;
    return true;
  }

 private:
  double reference_ = std::numeric_limits<double>::infinity();
  int since_ = 0;
};

template <class Real>
struct Packed {
  PackedProblem<Real> problem;
  Momentum<Real> momentum;
};

template <class Real>
struct Iterate {
  double residual = std::numeric_limits<double>::infinity();
  std::vector<Batch<Real>> batches;
};

template <class Real>
SolveReport solve_packed(const ConeProblem& problem, const SolverOptions& options, const Colouring& colouring,
                         std::span<Impulse> impulse, std::vector<Vec3>& velocity, std::vector<Vec3>& angular_velocity,
                         Packed<Real>& room) {
  const int threads = problem.contacts.size() < worth_a_thread ? 1 : options.threads;
  PackedProblem<Real>& packed = room.problem;
  pack<Real>(problem, colouring, impulse, threads, packed);
  renew_friction(packed, problem, threads);
  SolveReport report;
  report.bytes = packed.bytes();
  report.residual = residual(packed, options.law, threads);

  std::optional<ProjectedGradient<Real>> gradient;
  if (options.kind != SolverKind::gauss_seidel) gradient.emplace(packed, problem, options.kind, options.law, threads);

  StagnationWatch watch;
  Iterate<Real> best;
  const bool many = problem.contacts.size() > many_contacts;
  Momentum<Real>* momentum = many && !gradient ? &room.momentum : nullptr;
  if (momentum != nullptr) {
    momentum->begin(packed, threads);
    report.bytes += momentum->bytes();
  }
  double relaxation = 1;
  int stride = many ? 8 : 2;  // iterations between two looks at the residual, which costs about half an iteration
  // A warm start that meets the tolerance is improved all the same: what is left over would add up from step to step.
  const auto unfinished = [&] {
    return report.residual > options.tolerance ||
           (report.iterations == 0 && report.residual > negligible * options.tolerance);
  };
  while (unfinished() && report.iterations < options.max_iterations) {
    const int n = std::min(stride, options.max_iterations - report.iterations);
    if (gradient) {
      report.iterations += gradient->phase(std::max(n, 4));
    } else {
      gauss_seidel(packed, options.law, n, relaxation, momentum, threads);
      report.iterations += n;
    }
    renew_friction(packed, problem, threads);
    const double before = report.residual;
    report.residual = residual(packed, options.law, threads);
    if (momentum != nullptr && report.residual > before) {
      momentum->falter();
    } else if (momentum != nullptr) {
      momentum->recover();
    }
    stride = std::min(stride + 2, 16);
    if (report.cycling && report.residual < best.residual) {
      best.residual = report.residual;
      best.batches = packed.batches;
    }
    if (watch.stands_still(report.residual, report.iterations)) {
      report.cycling = true;
      if (momentum == nullptr) relaxation = std::max(0.5, 0.7 * relaxation);
      momentum = nullptr;
      gradient.reset();
    }
  }
  if (best.residual < report.residual) {
    packed.batches = best.batches;
    report.residual = best.residual;
  }
  if (options.law == ContactLaw::exact && report.residual > std::max(hopeless, options.tolerance)) {
    SolverOptions convex = options;
    convex.law = ContactLaw::relaxed;
    const double exact_residual = report.residual;
    const SolveReport other = solve_packed<Real>(problem, convex, colouring, impulse, velocity, angular_velocity, room);
    report.iterations += other.iterations;
    report.residual = exact_residual;
    report.converged = false;
    report.cycling = true;
    return report;
  }
  unpack(packed, problem, impulse, velocity, angular_velocity, threads);
  report.converged = report.residual <= options.tolerance;
  return report;
}

}  // namespace

struct SolverRoom::Space {
  Packed<float> coarse;
  Packed<double> fine;
};

SolverRoom::SolverRoom() : space_(std::make_unique<Space>()) {}
SolverRoom::~SolverRoom() = default;

SolveReport solve(const ConeProblem& problem, const SolverOptions& options, std::span<Impulse> impulse,
                  std::vector<Vec3>& velocity, std::vector<Vec3>& angular_velocity, SolverRoom& room) {
  velocity = problem.velocity;
  angular_velocity = problem.angular_velocity;
  if (problem.contacts.empty()) return {};
  const Colouring colouring = colour_contacts(problem, problem.contacts.size() < worth_a_thread ? 1 : options.threads);
  if (problem.contacts.size() > single_precision_above && options.tolerance >= 1e-5)
    return solve_packed<float>(problem, options, colouring, impulse, velocity, angular_velocity, room.space().coarse);
  return solve_packed<double>(problem, options, colouring, impulse, velocity, angular_velocity, room.space().fine);
}

}  // namespace repose::dvi
