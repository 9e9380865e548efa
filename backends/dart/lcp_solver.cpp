#include "backends/dart/lcp_solver.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include <dart/constraint/BoxedLcpConstraintSolver.hpp>
#include <dart/constraint/BoxedLcpSolver.hpp>
#include <dart/constraint/ConstraintBase.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>

#include "backends/dart/boxed_lcp.hpp"
#include "core/error.hpp"

namespace repose::dart {

namespace {

namespace engine = ::dart;

using engine::dynamics::BodyNode;
using Row = Eigen::Matrix<double, 6, 1>;  // moment, force

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Added to the diagonal, relative: the corners of a box then share their load in one way only, without which pivoting
/// breaks down. DART's default is 1e-5, the least it allows itself 1e-9. That share of the speed a contact takes away
/// is left.
constexpr double softness = 1e-9;

/// A step with more is refused: its matrix alone would take a gigabyte.
constexpr std::size_t most_rows = 10000;

/// Two unit vectors across `n`, the first along `motion` if that has a direction.
void frame_along(const Vec3& n, const Vec3& motion, Vec3& t1, Vec3& t2) {
  const Vec3 across = motion - n.dot(motion) * n;
  if (across.squaredNorm() > 1e-24 * motion.squaredNorm()) {
    t1 = across.normalized();
    t2 = n.cross(t1);
  } else {
    dvi::tangent_frame(n, t1, t2);
  }
}

/// One contact as rows of DART's problem: its directions, its bounds, and the impulse that comes out.
class ContactRows final : public engine::constraint::ConstraintBase {
 public:
  ContactRows(const dvi::ConeContact& contact, BodyNode* a, BodyNode* b, const Vec3& slip, const Vec3& turning)
      : contact_(contact), a_(a), b_(b) {
    Vec3 t1, t2, r1, r2;
    frame_along(contact.normal, slip, t1, t2);
    frame_along(contact.normal, turning, r1, r2);
    add_force(contact.normal, -(contact.normal.dot(slip) + contact.bias), infinity, false);
    if (contact.friction > 0) {
      add_force(t1, -t1.dot(slip), contact.friction, true);
      add_force(t2, -t2.dot(slip), contact.friction, true);
    }
    // Angular rows are velocities too: divided by the arm their impulses are moments.
    if (contact.rolling > 0) {
      add_moment(r1, -contact.arm * r1.dot(turning), contact.rolling);
      add_moment(r2, -contact.arm * r2.dot(turning), contact.rolling);
    }
    if (contact.spinning > 0) add_moment(contact.normal, -contact.arm * contact.normal.dot(turning), contact.spinning);
  }

  const ContactImpulse& impulse() const { return impulse_; }

  void update() override {}
  bool isActive() const override { return true; }

  void getInformation(engine::constraint::ConstraintInfo* info) override {
    for (std::size_t i = 0; i < mDim; ++i) {
      info->b[i] = wanted_[i];
      info->hi[i] = limit_[i];
      info->lo[i] = coupled_[i] ? -limit_[i] : 0.0;
      info->findex[i] = coupled_[i] ? 0 : -1;  // the normal row of this contact
    }
  }

  void applyUnitImpulse(std::size_t row) override {
    excited_ = row;
    push(a_, -row_a_[row]);
    push(b_, row_b_[row]);
  }

  void getVelocityChange(double* change, bool diagonal) override {
    for (std::size_t i = 0; i < mDim; ++i) {
      change[i] = 0;
      if (moved(a_)) change[i] -= row_a_[i].dot(a_->getBodyVelocityChange());
      if (moved(b_)) change[i] += row_b_[i].dot(b_->getBodyVelocityChange());
    }
    if (diagonal) change[excited_] *= 1 + softness;
  }

  void excite() override { set_excited(true); }
  void unexcite() override { set_excited(false); }

  void applyImpulse(double* x) override {
    impulse_ = {};
    impulse_.force -= contact_.cohesion * contact_.normal;
    for (std::size_t i = 0; i < mDim; ++i) {
      impulse_.force += x[i] * force_[i];
      impulse_.couple += x[i] * moment_[i];
    }
  }

  engine::dynamics::SkeletonPtr getRootSkeleton() const override {
    return ConstraintBase::getRootSkeleton((a_ ? a_ : b_)->getSkeleton());
  }

  void uniteSkeletons() override {
    if (!a_ || !b_) return;
    const auto root_a = compressPath(a_->getSkeleton()), root_b = compressPath(b_->getSkeleton());
    if (root_a == root_b) return;
    const bool a_grows = root_a->mUnionSize >= root_b->mUnionSize;
    const auto& large = a_grows ? root_a : root_b;
    const auto& small = a_grows ? root_b : root_a;
    small->mUnionRootSkeleton = large;
    large->mUnionSize += small->mUnionSize;
  }

 private:
  void add_force(const Vec3& direction, double wanted, double limit, bool coupled) {
    add(direction, Vec3::Zero(), contact_.arm_a.cross(direction), contact_.arm_b.cross(direction), wanted, limit,
        coupled);
  }
  void add_moment(const Vec3& axis, double wanted, double limit) {
    const Vec3 moment = contact_.arm * axis;
    add(Vec3::Zero(), moment, moment, moment, wanted, limit, true);
  }
  void add(const Vec3& force, const Vec3& couple, const Vec3& moment_a, const Vec3& moment_b, double wanted,
           double limit, bool coupled) {
    force_[mDim] = force;
    moment_[mDim] = couple;
    row_a_[mDim] << moment_a, force;
    row_b_[mDim] << moment_b, force;
    wanted_[mDim] = wanted;
    limit_[mDim] = limit;
    coupled_[mDim] = coupled;
    ++mDim;
  }

  static bool moved(const BodyNode* body) { return body && body->getSkeleton()->isImpulseApplied(); }

  void push(BodyNode* body, const Row& impulse) {
    if (!body) return;
    const auto skeleton = body->getSkeleton();
    skeleton->clearConstraintImpulses();
    skeleton->updateBiasImpulse(body, impulse);
    skeleton->updateVelocityChange();
  }

  void set_excited(bool on) {
    if (a_) a_->getSkeleton()->setImpulseApplied(on);
    if (b_) b_->getSkeleton()->setImpulseApplied(on);
  }

  const dvi::ConeContact& contact_;
  BodyNode *a_, *b_;  // null: prescribed
  std::array<Vec3, 6> force_, moment_;
  std::array<Row, 6> row_a_, row_b_;
  std::array<double, 6> wanted_{}, limit_{};
  std::array<bool, 6> coupled_{};
  std::size_t excited_ = 0;
  ContactImpulse impulse_;
};

/// The solver that DART's islands are handed to.
class CoupledBounds final : public engine::constraint::BoxedLcpSolver {
 public:
  void begin(double tolerance, int max_passes) {
    tolerance_ = tolerance;
    max_passes_ = max_passes;
    report_ = {};
  }
  const LcpSolverReport& report() const { return report_; }

  const std::string& getType() const override {
    static const std::string type = "CoupledBounds";
    return type;
  }

  bool solve(int n, double* a, double* x, double* b, int, double* lo, double* hi, int* parent, bool) override {
    const auto rows = static_cast<std::size_t>(n);
    BoxedLcp problem;
    problem.rows = n;
    problem.stride = n > 1 ? ((n - 1) | 3) + 1 : n;  // rows of DART's matrices start at multiples of four
    problem.a = {a, rows * static_cast<std::size_t>(problem.stride)};
    problem.b = {b, rows};
    problem.lo = {lo, rows};
    problem.hi = {hi, rows};
    problem.parent = {parent, rows};
    const LcpReport island = repose::dart::solve(problem, tolerance_, max_passes_, {x, rows});
    report_.iterations = std::max(report_.iterations, island.passes);
    report_.residual = std::max(report_.residual, island.residual);
    report_.converged = report_.converged && island.converged;
    report_.swept = report_.swept || island.swept;
    return true;
  }

  bool canSolve(int, const double*) override { return true; }

 private:
  double tolerance_ = 0;
  int max_passes_ = 0;
  LcpSolverReport report_;
};

/// DART's solver with this step's contacts as its only constraints.
class Islands final : public engine::constraint::BoxedLcpConstraintSolver {
 public:
  explicit Islands(const std::shared_ptr<CoupledBounds>& solver) : BoxedLcpConstraintSolver(solver, nullptr) {}
  void take(const std::vector<std::shared_ptr<ContactRows>>& contacts) {
    mManualConstraints.assign(contacts.begin(), contacts.end());
  }
};

/// Adds M^-1 J' impulse to the velocities.
void apply(const dvi::ConeProblem& problem, const dvi::ConeContact& c, const Vec3& force, const Vec3& couple,
           std::vector<Vec3>& velocity, std::vector<Vec3>& angular_velocity) {
  const auto push = [&](std::int32_t body, const Vec3& arm, double sign) {
    const auto i = static_cast<std::size_t>(body);
    const dvi::InverseMass& m = problem.inverse_mass[i];
    const Vec3 moment = arm.cross(force) + couple;
    Mat3 inertia;
    inertia << m.inertia[0], m.inertia[1], m.inertia[2], m.inertia[1], m.inertia[3], m.inertia[4], m.inertia[2],
        m.inertia[4], m.inertia[5];
    velocity[i] += sign * m.mass * force;
    angular_velocity[i] += sign * (inertia * moment);
  };
  push(c.a, c.arm_a, -1);
  push(c.b, c.arm_b, 1);
}

}  // namespace

struct LcpSolver::Engine {
  std::vector<BodyNode*> body;
  std::shared_ptr<CoupledBounds> lcp = std::make_shared<CoupledBounds>();
  Islands islands{lcp};
  std::vector<std::shared_ptr<ContactRows>> rows;
};

LcpSolver::LcpSolver(std::size_t dynamic_bodies) : engine_(std::make_unique<Engine>()) {
  engine_->islands.setTimeStep(1.0);  // impulses only: no step enters
  for (std::size_t i = 0; i < dynamic_bodies; ++i) {
    const auto skeleton = engine::dynamics::Skeleton::create(std::to_string(i));
    engine_->body.push_back(skeleton->createJointAndBodyNodePair<engine::dynamics::FreeJoint>().second);
    engine_->islands.addSkeleton(skeleton);
  }
}

LcpSolver::~LcpSolver() = default;

LcpSolverReport LcpSolver::solve(const dvi::ConeProblem& problem, double tolerance, int max_passes,
                                 std::vector<ContactImpulse>& impulse, std::vector<Vec3>& velocity,
                                 std::vector<Vec3>& angular_velocity) {
  // DART's bodies stand still at the origin with world axes: the rows say where the contacts are.
  for (std::size_t i = 0; i < engine_->body.size(); ++i) {
    const dvi::InverseMass& m = problem.inverse_mass[i];
    Mat3 inverse;
    inverse << m.inertia[0], m.inertia[1], m.inertia[2], m.inertia[1], m.inertia[3], m.inertia[4], m.inertia[2],
        m.inertia[4], m.inertia[5];
    engine_->body[i]->setInertia(engine::dynamics::Inertia(1 / m.mass, Vec3::Zero(), inverse.inverse()));
  }
  velocity = problem.velocity;
  angular_velocity = problem.angular_velocity;
  // Attraction acts whatever the contact does; what is left is a contact without cohesion.
  for (const dvi::ConeContact& c : problem.contacts)
    if (c.cohesion > 0) apply(problem, c, -c.cohesion * c.normal, Vec3::Zero(), velocity, angular_velocity);
  const auto node = [&](std::int32_t body) {
    return body < problem.dynamic_bodies ? engine_->body[static_cast<std::size_t>(body)] : nullptr;
  };
  engine_->rows.clear();
  for (const dvi::ConeContact& c : problem.contacts) {
    const auto a = static_cast<std::size_t>(c.a), b = static_cast<std::size_t>(c.b);
    const Vec3 slip =
        velocity[b] + angular_velocity[b].cross(c.arm_b) - velocity[a] - angular_velocity[a].cross(c.arm_a);
    engine_->rows.push_back(
        std::make_shared<ContactRows>(c, node(c.a), node(c.b), slip, angular_velocity[b] - angular_velocity[a]));
  }
  std::size_t rows = 0;
  for (const auto& contact : engine_->rows) rows += contact->getDimension();
  if (rows > most_rows)
    throw Error("dart",
                "the " + std::to_string(problem.contacts.size()) + " contacts of a step make " + std::to_string(rows) +
                    " rows of a full matrix",
                "DART is for small scenes, at most " + std::to_string(most_rows) +
                    " rows: use fewer grains, or another backend",
                Error::Kind::simulation);
  engine_->lcp->begin(tolerance, max_passes);
  engine_->islands.take(engine_->rows);
  engine_->islands.solve();
  for (BodyNode* body : engine_->body) body->getSkeleton()->setImpulseApplied(false);

  velocity = problem.velocity;
  angular_velocity = problem.angular_velocity;
  impulse.resize(problem.contacts.size());
  for (std::size_t i = 0; i < impulse.size(); ++i) {
    impulse[i] = engine_->rows[i]->impulse();
    apply(problem, problem.contacts[i], impulse[i].force, impulse[i].couple, velocity, angular_velocity);
  }
  return engine_->lcp->report();
}

}  // namespace repose::dart
