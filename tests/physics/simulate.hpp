#pragma once
/// Runs a model on a named backend, step by step, as core/run.hpp does but without files.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "backends/backends.hpp"
#include "core/world.hpp"
#include "tests/support/model_builder.hpp"

namespace repose::test {

/// A time step h [s] with a solver that leaves nothing to chance: residual 1e-13 where rounding allows it.
inline SolverOptions precise(double step) {
  SolverOptions options;
  options.time_step = step;
  options.tolerance = 1e-13;
  options.max_iterations = 5000;
  return options;
}

/// As a user would run it: h [s] and a tolerance.
inline SolverOptions usual(double step, double tolerance = 1e-3) {
  SolverOptions options;
  options.time_step = step;
  options.tolerance = tolerance;
  return options;
}

class Simulation {
 public:
  /// Called after each step.
  using Watch = std::function<void(const Simulation&)>;

  Simulation(const std::string& backend, Model model, const SolverOptions& options)
      : model_(std::move(model)), options_(options), world_(find_backend(backend).make(model_, options)) {
    world_->read(state_);
  }

  /// The whole step, in as many parts as the backend takes; report() is of the last.
  void step() {
    for (double left = options_.time_step; left > 0; left = report_.left) {
      evaluate_loads(model_, state_, loads_);
      report_ = world_->step(left, loads_);
      world_->read(state_);
    }
  }

  Simulation& run(int steps, const Watch& watch = {}) {
    for (int i = 0; i < steps; ++i) {
      step();
      if (watch) watch(*this);
    }
    return *this;
  }

  const Model& model() const { return model_; }
  const Snapshot& state() const { return state_; }
  const StepReport& report() const { return report_; }  ///< of the last step
  World& world() { return *world_; }

  const Vec3& position(int body) const { return state_.position[static_cast<std::size_t>(body)]; }
  const Vec3& velocity(int body) const { return state_.velocity[static_cast<std::size_t>(body)]; }
  const Vec3& spin(int body) const { return state_.angular_velocity[static_cast<std::size_t>(body)]; }

  /// Of the last step.
  std::vector<Contact> contacts() const {
    std::vector<Contact> all;
    world_->read(all);
    return all;
  }
  /// Total contact force on `body` from `other` in the last step [N]; from all bodies if `other` < 0.
  Vec3 force_on(int body, int other = -1) const {
    Vec3 sum = Vec3::Zero();
    for (const Contact& c : contacts()) {
      if (c.b == body && (other < 0 || c.a == other)) sum += c.force;
      if (c.a == body && (other < 0 || c.b == other)) sum -= c.force;
    }
    return sum;
  }

  /// Continues from a saved frame with the state that the frame holds.
  void restore(const Frame& frame) {
    world_->restore(frame);
    world_->read(state_);
  }

 private:
  Model model_;
  SolverOptions options_;
  std::unique_ptr<World> world_;
  Snapshot state_;
  BodyLoads loads_;
  StepReport report_;
};

/// A test that is run once on every backend of the table; GetParam() is the backend's name.
class OnEveryBackend : public testing::TestWithParam<std::string> {
 protected:
  static Simulation simulation(const Model& model, const SolverOptions& options) {
    return {GetParam(), model, options};
  }
};

inline std::vector<std::string> backend_names() {
  std::vector<std::string> names;
  for (const Backend& backend : backends()) names.push_back(backend.name);
  return names;
}

}  // namespace repose::test

/// Leaves a test whose model asks for physics that the backend says it cannot do.
#define REPOSE_SKIP_UNSUPPORTED(model)                                                            \
  if (const auto missing = repose::find_backend(GetParam()).unsupported(model); !missing.empty()) \
  GTEST_SKIP() << GetParam() << " cannot do " << missing.front()

/// Makes the tests of a fixture derived from OnEveryBackend run on every backend.
#define REPOSE_ON_EVERY_BACKEND(fixture)                                                       \
  INSTANTIATE_TEST_SUITE_P(Backend, fixture, testing::ValuesIn(repose::test::backend_names()), \
                           [](const auto& backend) { return backend.param; })
