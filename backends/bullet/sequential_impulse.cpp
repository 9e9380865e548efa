#include "backends/bullet/sequential_impulse.hpp"

#include <BulletCollision/CollisionShapes/btEmptyShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "backends/bullet/bullet_math.hpp"
#include "backends/bullet/law_residual.hpp"

namespace repose::bullet {

namespace {

constexpr double removed_per_step = 0.5;  // of a penetration, by the split impulses
constexpr double slop = 5e-4;             // of R*: what is left of it; pushed to nothing, contacts at rest would flicker
constexpr double last_change = 0.5;       // of the tolerance: a sweep that changes less leaves a residual within it, on beds

double squared(double x) { return x * x; }

using dvi::ConeContact;
using dvi::ConeProblem;
using dvi::Impulse;

/// Bullet's sweeps over Bullet's rows, with round bounds. The bodies and contacts of the problem are the solver bodies and
/// contact rows of the same index.
class Sweeps final : public btSequentialImpulseConstraintSolver {
 public:
  void prepare(const ConeProblem& problem, std::span<const double> gap, double step, std::span<Impulse> impulse) {
    problem_ = &problem;
    gap_ = gap;
    step_ = step;
    impulse_ = impulse;
  }
  void collect(std::vector<Vec3>& velocity, std::vector<Vec3>& angular_velocity,
               std::vector<dvi::Displacement>& displacement) {
    velocity_ = &velocity;
    angular_ = &angular_velocity;
    displacement_ = &displacement;
  }

 protected:
  btScalar solveGroupCacheFriendlySetup(btCollisionObject** bodies, int body_count, btPersistentManifold** manifolds,
                                        int manifold_count, btTypedConstraint** joints, int joint_count,
                                        const btContactSolverInfo& info, btIDebugDraw* draw) override {
    btSequentialImpulseConstraintSolver::solveGroupCacheFriendlySetup(bodies, body_count, manifolds, manifold_count, joints,
                                                                      joint_count, info, draw);
    const auto n = static_cast<int>(problem_->contacts.size());
    rolling_.assign(problem_->contacts.size(), -1);
    btConstraintArray& rolling = m_tmpSolverContactRollingFrictionConstraintPool;
    for (int r = 0; r < rolling.size(); ++r) {
      int& first = rolling_[static_cast<std::size_t>(rolling[r].m_frictionIndex)];
      if (first < 0) first = r;
    }
    for (int i = 0; i < n; ++i) {
      btSolverConstraint& row = m_tmpSolverContactConstraintPool[i];
      const double depth = std::max(-gap_[static_cast<std::size_t>(i)] - slop * contact(i).arm, 0.0);
      row.m_rhs -= contact(i).bias * row.m_jacDiagABInv;
      row.m_rhsPenetration = removed_per_step * depth / step_ * row.m_jacDiagABInv;
      start(i, row);
    }
    return 0;
  }

  btScalar solveSingleIteration(int iteration, btCollisionObject**, int, btPersistentManifold**, int, btTypedConstraint**,
                                int, const btContactSolverInfo&, btIDebugDraw*) override {
    const int n = m_tmpSolverContactConstraintPool.size();
    double change = 0, size = 0;  // sums of l |dg|^2 and l |g|^2, as in the residual of the law
    for (int i = 0; i < n; ++i) {
      const ConeContact& c = contact(i);
      btSolverConstraint& row = m_tmpSolverContactConstraintPool[i];
      // The split impulses, which are done before the first sweep, must not pull.
      if (iteration == 0) row.m_lowerLimit = -c.cohesion;
      btSolverBody& b = m_tmpSolverBodyPool[row.m_solverBodyIdA];
      btSolverBody& a = m_tmpSolverBodyPool[row.m_solverBodyIdB];
      const double before = row.m_appliedImpulse;
      resolveSingleConstraintRowLowerLimit(b, a, row);
      double changed = squared(row.m_appliedImpulse - before), held = squared(row.m_appliedImpulse);
      const double pressed = row.m_appliedImpulse + c.cohesion;
      if (c.friction > 0) {
        btSolverConstraint* slide = &m_tmpSolverContactFrictionConstraintPool[row.m_frictionIndex];
        changed += within_disc(b, a, slide[0], slide[1], c.friction * pressed);
        held += squared(slide[0].m_appliedImpulse) + squared(slide[1].m_appliedImpulse);
      }
      if (const int r = rolling_[static_cast<std::size_t>(i)]; r >= 0) {
        btSolverConstraint* turn = &m_tmpSolverContactRollingFrictionConstraintPool[r];
        const double spun = turn[0].m_appliedImpulse;
        turn[0].m_upperLimit = c.spinning * c.arm * pressed;
        turn[0].m_lowerLimit = -turn[0].m_upperLimit;
        resolveSingleConstraintRowGeneric(b, a, turn[0]);
        const double rolled = within_disc(b, a, turn[1], turn[2], c.rolling * c.arm * pressed);
        changed += (squared(turn[0].m_appliedImpulse - spun) + rolled) / squared(c.arm);
        for (int k = 0; k < 3; ++k) held += squared(turn[k].m_appliedImpulse / c.arm);
      }
      change += changed / row.m_jacDiagABInv;
      size += held / row.m_jacDiagABInv;
    }
    if (change == 0) return 0;
    return std::min(change / std::max(size, std::numeric_limits<double>::min()), std::numeric_limits<double>::max());
  }

  btScalar solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int body_count,
                                         const btContactSolverInfo& info) override {
    for (int i = 0; i < static_cast<int>(problem_->contacts.size()); ++i) {
      const btSolverConstraint& row = m_tmpSolverContactConstraintPool[i];
      const btSolverConstraint* slide = &m_tmpSolverContactFrictionConstraintPool[row.m_frictionIndex];
      Impulse& g = impulse_[static_cast<std::size_t>(i)];
      g = {row.m_appliedImpulse, slide[0].m_appliedImpulse, slide[1].m_appliedImpulse, 0, 0, 0};
      const int r = rolling_[static_cast<std::size_t>(i)];
      if (r < 0) continue;
      Vec3 moment = Vec3::Zero();
      for (int k = 0; k < 3; ++k) {
        const btSolverConstraint& turn = m_tmpSolverContactRollingFrictionConstraintPool[r + k];
        moment += static_cast<double>(turn.m_appliedImpulse) * from_bullet(turn.m_relpos1CrossNormal);
      }
      Vec3 t1, t2;
      dvi::tangent_frame(contact(i).normal, t1, t2);
      moment /= contact(i).arm;
      g[3] = t1.dot(moment);
      g[4] = t2.dot(moment);
      g[5] = contact(i).normal.dot(moment);
    }
    for (int i = 0; i < problem_->dynamic_bodies; ++i) {
      const btSolverBody& body = m_tmpSolverBodyPool[i];
      const auto k = static_cast<std::size_t>(i);
      (*velocity_)[k] = from_bullet(body.m_linearVelocity + body.getDeltaLinearVelocity());
      (*angular_)[k] = from_bullet(body.m_angularVelocity + body.getDeltaAngularVelocity());
      (*displacement_)[k] = {step_ * from_bullet(body.getPushVelocity()), step_ * from_bullet(body.getTurnVelocity())};
    }
    return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyFinish(bodies, body_count, info);
  }

 private:
  const ConeContact& contact(int i) const { return problem_->contacts[static_cast<std::size_t>(i)]; }

  /// First impulses: those that the caller brings.
  void start(int i, btSolverConstraint& row) {
    const Impulse& g = impulse_[static_cast<std::size_t>(i)];
    btSolverBody& b = m_tmpSolverBodyPool[row.m_solverBodyIdA];
    btSolverBody& a = m_tmpSolverBodyPool[row.m_solverBodyIdB];
    add(b, a, row, g[0]);
    if (contact(i).friction > 0) {  // a normal that has turned since gives even a smooth contact a share along its tangents
      btSolverConstraint* slide = &m_tmpSolverContactFrictionConstraintPool[row.m_frictionIndex];
      add(b, a, slide[0], g[1]);
      add(b, a, slide[1], g[2]);
    }
    const int r = rolling_[static_cast<std::size_t>(i)];
    if (r < 0) return;
    Vec3 t1, t2;
    dvi::tangent_frame(contact(i).normal, t1, t2);
    const Vec3 moment = contact(i).arm * (g[3] * t1 + g[4] * t2 + g[5] * contact(i).normal);
    for (int k = 0; k < 3; ++k) {
      btSolverConstraint& turn = m_tmpSolverContactRollingFrictionConstraintPool[r + k];
      add(b, a, turn, from_bullet(turn.m_relpos1CrossNormal).dot(moment));
    }
  }

  static void add(btSolverBody& b, btSolverBody& a, btSolverConstraint& row, double impulse) {
    if (impulse == 0) return;
    row.m_appliedImpulse = row.m_appliedImpulse + impulse;
    b.internalApplyImpulse(row.m_contactNormal1 * b.internalGetInvMass(), row.m_angularComponentA, impulse);
    a.internalApplyImpulse(row.m_contactNormal2 * a.internalGetInvMass(), row.m_angularComponentB, impulse);
  }

  /// What would bring the row's velocity to zero, the other rows held.
  static double wanted(btSolverBody& b, btSolverBody& a, const btSolverConstraint& row) {
    const double moved = row.m_contactNormal1.dot(b.internalGetDeltaLinearVelocity()) +
                         row.m_relpos1CrossNormal.dot(b.internalGetDeltaAngularVelocity()) +
                         row.m_contactNormal2.dot(a.internalGetDeltaLinearVelocity()) +
                         row.m_relpos2CrossNormal.dot(a.internalGetDeltaAngularVelocity());
    return row.m_rhs - moved * row.m_jacDiagABInv;
  }

  /// Two rows whose impulse stays within a disc: each row's own answer where that lies inside; else one step of the same
  /// length in both and the nearest point of the disc, whose fixed point is opposed to the sliding exactly. Returns the
  /// square of the change.
  static double within_disc(btSolverBody& b, btSolverBody& a, btSolverConstraint& x, btSolverConstraint& y, double limit) {
    const double before_x = x.m_appliedImpulse, before_y = y.m_appliedImpulse;
    double dx = wanted(b, a, x), dy = wanted(b, a, y);
    if (squared(before_x + dx) + squared(before_y + dy) > squared(limit)) {
      const double step = std::min(x.m_jacDiagABInv, y.m_jacDiagABInv);
      const double gx = before_x + dx * (step / x.m_jacDiagABInv), gy = before_y + dy * (step / y.m_jacDiagABInv);
      const double length = std::sqrt(squared(gx) + squared(gy)), share = length > limit ? limit / length : 1.0;
      dx = share * gx - before_x;
      dy = share * gy - before_y;
    }
    add(b, a, x, dx);
    add(b, a, y, dy);
    return dx * dx + dy * dy;
  }

  const ConeProblem* problem_ = nullptr;
  std::span<const double> gap_;
  double step_ = 0;
  std::span<Impulse> impulse_;
  std::vector<int> rolling_;  // first of the three rows of a contact (spinning, rolling, rolling), -1: none
  std::vector<Vec3>*velocity_ = nullptr, *angular_ = nullptr;
  std::vector<dvi::Displacement>* displacement_ = nullptr;
};

}  // namespace

struct SequentialImpulse::Engine {
  btEmptyShape no_shape;
  Sweeps sweeps;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<btCollisionObject*> objects;
  std::vector<std::unique_ptr<btPersistentManifold>> manifolds;
  std::vector<btPersistentManifold*> used;
  std::vector<dvi::Displacement> displacement;

  /// Bodies stand at the origin: a contact's place on each is then its lever, without loss of digits.
  void place_bodies(const ConeProblem& problem, std::span<const MassAndAxes> mass) {
    while (bodies.size() < mass.size()) {
      bodies.push_back(std::make_unique<btRigidBody>(1, nullptr, &no_shape, btVector3(1, 1, 1)));
      bodies.back()->setFlags(0);  // no gyroscopic terms
      bodies.back()->setWorldArrayIndex(static_cast<int>(objects.size()));
      objects.push_back(bodies.back().get());
    }
    for (std::size_t i = 0; i < mass.size(); ++i) {
      btRigidBody& body = *bodies[i];
      const bool dynamic = static_cast<std::int32_t>(i) < problem.dynamic_bodies;
      body.setMassProps(dynamic ? mass[i].mass : 0, to_bullet<btVector3>(mass[i].inertia));
      if (!dynamic) body.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
      body.setWorldTransform(btTransform(to_bullet<btMatrix3x3>(mass[i].rotation)));
      body.updateInertiaTensor();
      body.setLinearVelocity(to_bullet<btVector3>(problem.velocity[i]));
      body.setAngularVelocity(to_bullet<btVector3>(problem.angular_velocity[i]));
      body.clearForces();
    }
  }

  /// Contacts of one pair share manifolds of up to four points; the order of contacts stays.
  void place_contacts(const ConeProblem& problem) {
    used.clear();
    const ConeContact* last = nullptr;
    for (const ConeContact& c : problem.contacts) {
      const bool same = last && last->a == c.a && last->b == c.b && used.back()->getNumContacts() < MANIFOLD_CACHE_SIZE;
      if (!same) {
        if (used.size() == manifolds.size())
          manifolds.push_back(std::make_unique<btPersistentManifold>(nullptr, nullptr, 0, BT_LARGE_FLOAT, BT_LARGE_FLOAT));
        used.push_back(manifolds[used.size()].get());
        used.back()->setNumContacts(0);
        used.back()->setBodies(objects[static_cast<std::size_t>(c.b)], objects[static_cast<std::size_t>(c.a)]);
      }
      last = &c;
      const int k = used.back()->getNumContacts();
      used.back()->setNumContacts(k + 1);
      btManifoldPoint& point = used.back()->getContactPoint(k);
      point = btManifoldPoint(btVector3(0, 0, 0), btVector3(0, 0, 0), to_bullet<btVector3>(c.normal), 0);
      point.m_positionWorldOnA = to_bullet<btVector3>(c.arm_b);
      point.m_positionWorldOnB = to_bullet<btVector3>(c.arm_a);
      point.m_combinedFriction = c.friction;
      // Bullet makes the three rows of a moment, spinning included, only where rolling friction is positive.
      point.m_combinedRollingFriction = c.rolling > 0 || c.spinning > 0 ? 1 : 0;
      point.m_contactPointFlags = BT_CONTACT_FLAG_LATERAL_FRICTION_INITIALIZED;
      Vec3 t1, t2;
      dvi::tangent_frame(c.normal, t1, t2);
      point.m_lateralFrictionDir1 = to_bullet<btVector3>(t1);
      point.m_lateralFrictionDir2 = to_bullet<btVector3>(t2);
    }
  }
};

SequentialImpulse::SequentialImpulse() : engine_(std::make_unique<Engine>()) {}
SequentialImpulse::~SequentialImpulse() = default;

const std::vector<dvi::Displacement>& SequentialImpulse::displacement() const { return engine_->displacement; }

dvi::SolveReport SequentialImpulse::solve(const ConeProblem& problem, std::span<const MassAndAxes> mass,
                                          std::span<const double> gap, double step, const SolverOptions& options,
                                          std::span<Impulse> impulse, std::vector<Vec3>& velocity,
                                          std::vector<Vec3>& angular_velocity) {
  velocity = problem.velocity;
  angular_velocity = problem.angular_velocity;
  engine_->displacement.assign(problem.velocity.size(), {});
  dvi::SolveReport report;
  if (problem.contacts.empty()) return report;

  engine_->place_bodies(problem, mass);
  engine_->place_contacts(problem);
  btContactSolverInfo info;
  info.m_timeStep = step;
  info.m_numIterations = options.max_iterations;
  info.m_leastSquaresResidualThreshold = squared(last_change * options.tolerance);
  info.m_solverMode = SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_ENABLE_FRICTION_DIRECTION_CACHING;
  info.m_splitImpulse = 1;
  info.m_restitutionVelocityThreshold = 0;
  engine_->sweeps.prepare(problem, gap, step, impulse);
  engine_->sweeps.collect(velocity, angular_velocity, engine_->displacement);
  engine_->sweeps.solveGroup(engine_->objects.data(), static_cast<int>(mass.size()), engine_->used.data(),
                             static_cast<int>(engine_->used.size()), nullptr, 0, info, nullptr, nullptr);
  report.iterations = engine_->sweeps.m_analyticsData.m_numIterationsUsed;
  report.residual = law_residual(problem, impulse, velocity, angular_velocity);
  report.converged = report.residual <= options.tolerance;
  return report;
}

}  // namespace repose::bullet
