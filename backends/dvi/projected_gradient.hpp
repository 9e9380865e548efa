#pragma once
/// Projected gradient methods on the whole problem: APGD (Nesterov's acceleration with adaptive step and restart; Mazhar et
/// al. 2015) and Barzilai-Borwein steps. Both minimise  f(g) = 1/2 g'N g + g'q  over the product of the cones, in variables
/// scaled per contact by sqrt(mean of the diagonal of W).
///
/// The exact law is met by an outer fixed point: q holds De Saxce's correction of the last velocities, and is renewed at the
/// start of every phase.
#include <memory>
#include <vector>

#include "backends/dvi/packed_problem.hpp"
#include "core/world.hpp"

namespace repose::dvi {

template <class Real>
class ProjectedGradient {
 public:
  ProjectedGradient(PackedProblem<Real>& packed, const ConeProblem& problem, SolverKind kind, ContactLaw law, int threads);
  ~ProjectedGradient();
  ProjectedGradient(const ProjectedGradient&) = delete;
  ProjectedGradient& operator=(const ProjectedGradient&) = delete;

  /// One phase of `iterations` steps. Leaves impulses and velocities of the packed problem consistent. Returns the number
  /// of products with N, the unit of cost that it shares with a Gauss-Seidel sweep.
  int phase(int iterations);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

extern template class ProjectedGradient<double>;
extern template class ProjectedGradient<float>;

}  // namespace repose::dvi
