#pragma once
/// A cone problem laid out for speed: contacts in batches of one vector register, colour after colour (of the blocks, then those
/// between blocks: colouring.hpp), bodies as two cache lines each. The kernels of all solvers work on it.
///
/// Notation: g impulse, u relative velocity (rows of cone_problem.hpp), W = J M^-1 J' the 6 x 6 block of one contact.
#include <cstdint>
#include <span>
#include <vector>

#include "backends/dvi/colouring.hpp"
#include "backends/dvi/cone_problem.hpp"
#include "backends/dvi/lanes.hpp"

namespace repose::dvi {

/// Rows and columns of the symmetric W, upper triangle row by row.
constexpr int block_index(int i, int j) {
  if (i > j) return block_index(j, i);
  return i * 6 - i * (i - 1) / 2 + (j - i);
}

template <class Real>
struct alignas(lane_bytes) Batch {
  using V = Lanes<Real>;
  V normal[3], tangent[3];   ///< the second tangent is their cross product
  V arm_a[3], arm_b[3];
  V w[21];                   ///< block W
  V impulse[6];
  V bias, friction, rolling, spinning, arm, cohesion;
  std::int32_t a[lane_count<Real>], b[lane_count<Real>];  ///< bodies; padding lanes: the idle body
};

/// Lanes as an element of a container (a bare vector type loses its attribute as a template argument).
template <class Real>
struct alignas(lane_bytes) OneLane {
  Lanes<Real> x;
};

/// Velocity of a body, one cache line (64 bytes in double, half of it in single precision).
template <class Real>
struct alignas(8 * sizeof(Real)) BodyVelocity {
  Real linear[3], pad0, angular[3], pad1;
};

template <class Real>
struct alignas(8 * sizeof(Real)) BodyInverse {
  Real inertia[6], mass, lift;
};

template <class Real>
struct PackedProblem {
  static constexpr int lanes = lane_count<Real>;

  std::int32_t dynamic_bodies = 0;
  std::vector<BodyVelocity<Real>> velocity;   ///< dynamic, prescribed, and one idle body that padding lanes point to
  std::vector<BodyInverse<Real>> inverse;
  std::vector<Batch<Real>> batches;
  std::vector<std::int32_t> colour_start;     ///< of each colour in `batches`, plus the end
  std::vector<std::int32_t> block_start;      ///< of each block in `batches`, plus the end of the last
  int first_between = 0;                      ///< first colour of the contacts between blocks
  std::vector<std::int32_t> contact;          ///< contact of each lane of each batch, -1: padding
  std::vector<OneLane<Real>> compliance;      ///< of each batch; empty if all contacts are rigid
  Real across = 1;                            ///< ConeProblem::across: row 2 is that of across * (second tangent)
  bool rotational = false;                    ///< some contact has rolling or spinning friction
  double kinetic_scale = 0;                   ///< sqrt(sum m v^2) of the free motion [sqrt(J)]

  int colours() const { return static_cast<int>(colour_start.size()) - 1; }
  int blocks() const { return static_cast<int>(block_start.size()) - 1; }
  std::size_t bytes() const;                  ///< of the arrays above
  std::size_t padded_contacts() const { return batches.size() * static_cast<std::size_t>(lanes); }
};

/// Packs the problem with the given first impulses (one per contact), whose effect is added to the free velocities. The room of
/// `packed` serves again: that of a problem of many contacts, asked for anew, costs more than filling it.
template <class Real>
void pack(const ConeProblem& problem, const Colouring& colouring, std::span<const Impulse> impulse, int threads,
          PackedProblem<Real>& packed);

/// Recomputes velocity = free velocity + M^-1 J' g from the impulses that the batches hold.
template <class Real>
void accumulate_velocities(PackedProblem<Real>& packed, const ConeProblem& problem, int threads);

/// Copies the impulses out, and computes in double precision the velocities of the dynamic bodies that they give.
/// `velocity` and `angular_velocity` come in as the free velocities.
template <class Real>
void unpack(const PackedProblem<Real>& packed, const ConeProblem& problem, std::span<Impulse> impulse,
            std::vector<Vec3>& velocity, std::vector<Vec3>& angular_velocity, int threads);

extern template struct PackedProblem<double>;
extern template struct PackedProblem<float>;

}  // namespace repose::dvi
