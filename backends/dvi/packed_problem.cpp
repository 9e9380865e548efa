#include "backends/dvi/packed_problem.hpp"

#include <cmath>

#include "backends/dvi/batch_kernels.hpp"
#include "backends/dvi/resize.hpp"
#include "backends/dvi/team.hpp"

namespace repose::dvi {

namespace {

template <class Real>
void set3(Lanes<Real>* out, int lane, const Vec3& x) {
  for (int k = 0; k < 3; ++k) out[k][lane] = static_cast<Real>(x[k]);
}

/// Padding lanes: a contact of the idle body with itself, whose impulse stays zero because mass never moves it.
template <class Real>
void set_padding(Batch<Real>& batch, int lane, std::int32_t idle) {
  batch.a[lane] = batch.b[lane] = idle;
  set3<Real>(batch.normal, lane, Vec3::UnitZ());
  set3<Real>(batch.tangent, lane, Vec3::UnitX());
  set3<Real>(batch.arm_a, lane, Vec3::Zero());
  set3<Real>(batch.arm_b, lane, Vec3::Zero());
  for (auto& g : batch.impulse) g[lane] = 0;
  batch.bias[lane] = batch.friction[lane] = batch.rolling[lane] = batch.spinning[lane] = batch.cohesion[lane] = 0;
  batch.arm[lane] = 1;
}

/// W = sum over both bodies of J M^-1 J'. A positive floor on the diagonal keeps padding lanes finite.
template <class Real>
void compute_block(const PackedProblem<Real>& packed, Batch<Real>& c) {
  using V = Lanes<Real>;
  V t2[3];
  second_tangent<Real>(c, t2);
  const V* direction[3] = {c.normal, c.tangent, t2};
  for (V& w : c.w) w = V{};
  for (int side = 0; side < 2; ++side) {
    const V* arm = side == 0 ? c.arm_a : c.arm_b;
    V mass, lift, inertia[6];
    gather_inverse<Real>(packed.inverse.data(), side == 0 ? c.a : c.b, mass, lift, inertia);
    V turn[6][3], response[6][3];  // angular parts of the six rows
    for (int i = 0; i < 3; ++i) cross<Real>(arm, direction[i], turn[i]);
    for (int k = 0; k < 3; ++k) turn[2][k] *= packed.across;
    for (int k = 0; k < 3; ++k) {
      turn[3][k] = c.arm * c.tangent[k];
      turn[4][k] = c.arm * t2[k];
      turn[5][k] = c.arm * c.normal[k];
    }
    for (int i = 0; i < 6; ++i) multiply_symmetric<Real>(inertia, turn[i], response[i]);
    for (int i = 0; i < 6; ++i)
      for (int j = i; j < 6; ++j) c.w[block_index(i, j)] += dot<Real>(turn[i], response[j]);
    for (int i = 0; i < 3; ++i) c.w[block_index(i, i)] += i == 2 ? packed.across * packed.across * mass : mass;
    const V up[3] = {c.normal[2], c.tangent[2], packed.across * t2[2]};
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) c.w[block_index(i, j)] += lift * up[i] * up[j];
  }
  for (int i = 0; i < 6; ++i) {
    V& d = c.w[block_index(i, i)];
    d = d > 0 ? d : fill<Real>(1);
  }
}

}  // namespace

template <class Real>
std::size_t PackedProblem<Real>::bytes() const {
  return velocity.size() * sizeof(BodyVelocity<Real>) + inverse.size() * sizeof(BodyInverse<Real>) +
         batches.size() * sizeof(Batch<Real>) + compliance.size() * sizeof(OneLane<Real>) + contact.size() * sizeof(std::int32_t);
}

template <class Real>
void pack(const ConeProblem& problem, const Colouring& colouring, std::span<const Impulse> impulse, int threads,
          PackedProblem<Real>& packed) {
  constexpr int lanes = lane_count<Real>;
  packed.dynamic_bodies = problem.dynamic_bodies;
  const std::size_t bodies = problem.velocity.size();
  const auto idle = static_cast<std::int32_t>(bodies);
  packed.velocity.resize(bodies + 1);
  packed.inverse.resize(bodies + 1);
  packed.velocity.back() = {};
  packed.inverse.back() = {};
  const double energy = sum_over(threads, bodies, [&](std::size_t i) {
    BodyInverse<Real>& inverse = packed.inverse[i];
    inverse.mass = static_cast<Real>(problem.inverse_mass[i].mass);
    inverse.lift = static_cast<Real>(problem.inverse_mass[i].lift);
    for (std::size_t k = 0; k < 6; ++k) inverse.inertia[k] = static_cast<Real>(problem.inverse_mass[i].inertia[k]);
    return problem.inverse_mass[i].mass > 0 ? problem.velocity[i].squaredNorm() / problem.inverse_mass[i].mass : 0.0;
  });
  packed.kinetic_scale = std::sqrt(energy);

  packed.colour_start.assign(1, 0);
  for (int k = 0; k < colouring.colours(); ++k) {
    const auto n = colouring.start[static_cast<std::size_t>(k) + 1] - colouring.start[static_cast<std::size_t>(k)];
    packed.colour_start.push_back(packed.colour_start.back() + (n + lanes - 1) / lanes);
  }
  packed.block_start.clear();
  for (const std::int32_t colour : colouring.block) packed.block_start.push_back(packed.colour_start[static_cast<std::size_t>(colour)]);
  packed.first_between = colouring.block.back();
  resize_sparingly(packed.batches, static_cast<std::size_t>(packed.colour_start.back()));
  packed.contact.assign(packed.batches.size() * lanes, -1);
  for (int k = 0; k < colouring.colours(); ++k) {
    const auto first = static_cast<std::size_t>(colouring.start[static_cast<std::size_t>(k)]);
    const auto last = static_cast<std::size_t>(colouring.start[static_cast<std::size_t>(k) + 1]);
    const auto slot = static_cast<std::size_t>(packed.colour_start[static_cast<std::size_t>(k)]) * lanes;
    for (std::size_t i = first; i < last; ++i) packed.contact[slot + (i - first)] = colouring.order[i];
  }

  struct Kind {
    bool rotational = false, compliant = false;
  };
  Kind kind;
  for (const Kind& of_block : by_blocks(threads, problem.contacts.size(), [&](std::size_t first, std::size_t last) {
         Kind some;
         for (std::size_t i = first; i < last; ++i) {
           const ConeContact& c = problem.contacts[i];
           some.rotational = some.rotational || c.rolling > 0 || c.spinning > 0;
           some.compliant = some.compliant || c.compliance > 0;
         }
         return some;
       })) {
    kind.rotational = kind.rotational || of_block.rotational;
    kind.compliant = kind.compliant || of_block.compliant;
  }
  const auto [rotational, compliant] = kind;
  packed.rotational = rotational;
  packed.compliance.assign(compliant ? packed.batches.size() : 0, OneLane<Real>{});
  packed.across = static_cast<Real>(problem.across);

  const auto batches = static_cast<std::ptrdiff_t>(packed.batches.size());
  on_team(threads, [&] {
#pragma omp for schedule(static)
    for (std::ptrdiff_t i = 0; i < batches; ++i) {
      Batch<Real>& batch = packed.batches[static_cast<std::size_t>(i)];
      for (int l = 0; l < lanes; ++l) {
        const std::int32_t index = packed.contact[static_cast<std::size_t>(i * lanes + l)];
        if (index < 0) {
          set_padding(batch, l, idle);
          continue;
        }
        const ConeContact& c = problem.contacts[static_cast<std::size_t>(index)];
        const Impulse& g = impulse[static_cast<std::size_t>(index)];
        batch.a[l] = c.a;
        batch.b[l] = c.b;
        Vec3 t1, t2;
        contact_frame(c, t1, t2);
        set3<Real>(batch.normal, l, c.normal);
        set3<Real>(batch.tangent, l, t1);
        set3<Real>(batch.arm_a, l, c.arm_a);
        set3<Real>(batch.arm_b, l, c.arm_b);
        for (std::size_t k = 0; k < 6; ++k) batch.impulse[k][l] = rotational || k < 3 ? static_cast<Real>(g[k]) : Real(0);
        batch.impulse[2][l] /= packed.across;
        if (compliant) packed.compliance[static_cast<std::size_t>(i)].x[l] = static_cast<Real>(c.compliance);
        batch.bias[l] = static_cast<Real>(c.bias);
        batch.friction[l] = static_cast<Real>(c.friction);
        batch.rolling[l] = static_cast<Real>(c.rolling);
        batch.spinning[l] = static_cast<Real>(c.spinning);
        batch.arm[l] = static_cast<Real>(c.arm);
        batch.cohesion[l] = static_cast<Real>(c.cohesion);
      }
      compute_block(packed, batch);
      if (compliant) batch.w[0] += packed.compliance[static_cast<std::size_t>(i)].x;
    }
  });
  accumulate_velocities(packed, problem, threads);
}

template <class Real>
void accumulate_velocities(PackedProblem<Real>& packed, const ConeProblem& problem, int threads) {
  for_each_index(threads, problem.velocity.size(), [&](std::size_t i) {
    for (int k = 0; k < 3; ++k) {
      packed.velocity[i].linear[k] = static_cast<Real>(problem.velocity[i][k]);
      packed.velocity[i].angular[k] = static_cast<Real>(problem.angular_velocity[i][k]);
    }
  });
  with_rows(packed, [&](auto rotational) {
    constexpr bool rows = decltype(rotational)::value;
    on_team(threads, [&] {
      each_batch(packed, [&](std::size_t i) {
        const Batch<Real>& c = packed.batches[i];
        Lanes<Real> t2[3], force[3], couple[3], mass, lift, inertia[6], v[3], w[3];
        second_tangent<Real>(c, t2);
        wrench<Real, rows>(c, t2, packed.across, c.impulse, force, couple);
        for (int side = 0; side < 2; ++side) {
          const std::int32_t* index = side == 0 ? c.a : c.b;
          gather_velocity<Real>(packed.velocity.data(), index, v, w);
          gather_inverse<Real>(packed.inverse.data(), index, mass, lift, inertia);
          apply_wrench<Real>(side == 0 ? Real(-1) : Real(1), side == 0 ? c.arm_a : c.arm_b, mass, lift, inertia, force, couple, v, w);
          scatter_velocity<Real>(packed.velocity.data(), packed.dynamic_bodies, index, v, w);
        }
      });
    });
  });
}

template <class Real>
void unpack(const PackedProblem<Real>& packed, const ConeProblem& problem, std::span<Impulse> impulse,
            std::vector<Vec3>& velocity, std::vector<Vec3>& angular_velocity, int threads) {
  for_each_index(threads, packed.contact.size(), [&](std::size_t slot) {
    if (packed.contact[slot] < 0) return;
    const Batch<Real>& batch = packed.batches[slot / PackedProblem<Real>::lanes];
    const auto lane = static_cast<int>(slot % PackedProblem<Real>::lanes);
    for (std::size_t k = 0; k < 6; ++k)
      impulse[static_cast<std::size_t>(packed.contact[slot])][k] = static_cast<double>(batch.impulse[k][lane]);
    impulse[static_cast<std::size_t>(packed.contact[slot])][2] *= problem.across;
  });
  const auto apply = [&](std::int32_t body, const Vec3& force, const Vec3& torque) {
    const auto i = static_cast<std::size_t>(body);
    const InverseMass& m = problem.inverse_mass[i];
    velocity[i] += m.mass * force;
    velocity[i].z() += m.lift * force.z();
    angular_velocity[i] += Vec3(m.inertia[0] * torque.x() + m.inertia[1] * torque.y() + m.inertia[2] * torque.z(),
                                m.inertia[1] * torque.x() + m.inertia[3] * torque.y() + m.inertia[4] * torque.z(),
                                m.inertia[2] * torque.x() + m.inertia[4] * torque.y() + m.inertia[5] * torque.z());
  };
  // Every thread goes through all contacts and moves bodies of its own: each gets its impulses in the order of the contacts.
  for_each_index(threads, static_cast<std::size_t>(threads), [&](std::size_t part) {
    const auto bound = [&](std::size_t of) {
      return static_cast<std::int32_t>(static_cast<std::size_t>(problem.dynamic_bodies) * of / static_cast<std::size_t>(threads));
    };
    const std::int32_t first = bound(part), last = bound(part + 1);
    const auto own = [&](std::int32_t body) { return body >= first && body < last; };
    for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
      const ConeContact& c = problem.contacts[i];
      if (!own(c.a) && !own(c.b)) continue;
      const Impulse& g = impulse[i];
      Vec3 t1, t2;
      contact_frame(c, t1, t2);
      const Vec3 force = g[0] * c.normal + g[1] * t1 + g[2] * t2;
      const Vec3 couple = c.arm * (g[3] * t1 + g[4] * t2 + g[5] * c.normal);
      if (own(c.a)) apply(c.a, -force, -(c.arm_a.cross(force) + couple));
      if (own(c.b)) apply(c.b, force, c.arm_b.cross(force) + couple);
    }
  });
}

template struct PackedProblem<double>;
template struct PackedProblem<float>;
template void pack(const ConeProblem&, const Colouring&, std::span<const Impulse>, int, PackedProblem<double>&);
template void pack(const ConeProblem&, const Colouring&, std::span<const Impulse>, int, PackedProblem<float>&);
template void accumulate_velocities(PackedProblem<double>&, const ConeProblem&, int);
template void accumulate_velocities(PackedProblem<float>&, const ConeProblem&, int);
template void unpack(const PackedProblem<double>&, const ConeProblem&, std::span<Impulse>, std::vector<Vec3>&,
                     std::vector<Vec3>&, int);
template void unpack(const PackedProblem<float>&, const ConeProblem&, std::span<Impulse>, std::vector<Vec3>&,
                     std::vector<Vec3>&, int);

}  // namespace repose::dvi
