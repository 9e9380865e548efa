#include "core/run.hpp"

#include <gtest/gtest.h>

#include "core/atomic_file.hpp"
#include "core/recording_checkpoint.hpp"
#include "tests/unit/flying_world.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;

constexpr double h = 1.0 / 1024;

class RunTest : public testing::Test {
 protected:
  fs::path folder = fresh_folder("run"), other = fresh_folder("run-other");
  Model model = flying_model();
  Schedule schedule{h, 100 * h, 16 * h, 1e9};
  ~RunTest() override {
    fs::remove_all(folder);
    fs::remove_all(other);
  }

  RunReport run_in(const fs::path& place, const RunHooks& hooks, bool resume = false) {
    FlyingWorld world(model);
    Recorder recorder(place, model, "text", "fake", 1, resume);
    return run(world, model, schedule, &recorder, hooks, resume);
  }
  static RunHooks interrupt_after(int polls) {
    RunHooks hooks;
    hooks.interrupted = [count = 0, polls]() mutable { return count++ >= polls; };
    return hooks;
  }
  void expect_same_files() {
    EXPECT_TRUE(read_bytes(folder / "run.h5") == read_bytes(other / "run.h5"));
    EXPECT_TRUE(read_bytes(folder / "run.xmf") == read_bytes(other / "run.xmf"));
    for (const auto& entry : fs::directory_iterator(folder / "frames"))
      EXPECT_TRUE(read_bytes(entry.path()) == read_bytes(other / "frames" / entry.path().filename())) << entry.path();
  }
};

/// Symplectic Euler in free fall: z_n = z_0 + v_0 n h - g h^2 n (n + 1) / 2, exactly.
TEST_F(RunTest, FreeFlightIsTheDiscreteSum) {
  model.effects.clear();
  FlyingWorld world(model);
  const RunReport report = run(world, model, schedule, nullptr, {});
  EXPECT_EQ(report.end, RunReport::End::done);
  EXPECT_EQ(report.steps, 100);
  EXPECT_DOUBLE_EQ(report.final_state.time, 100 * h);
  const double z = model.initial.velocity[3].z() * 100 * h - 9.81 * h * h * 100 * 101 / 2;
  EXPECT_NEAR(report.final_state.position[3].z(), model.initial.position[3].z() + z, 1e-14);
}

TEST_F(RunTest, RecordsTheFirstEverySixteenthAndTheLastStep) {
  run_in(folder, {});
  const Recording r = read_recording(folder / "run.h5");
  std::vector<double> steps;
  for (const Snapshot& frame : r.frames) steps.push_back(frame.time / h);
  EXPECT_EQ(steps, (std::vector<double>{0, 16, 32, 48, 64, 80, 96, 100}));
  ASSERT_EQ(r.steps.size(), 100u);
  EXPECT_EQ(r.steps.front().time, h);
  EXPECT_EQ(r.steps.back().time, 100 * h);
}

TEST_F(RunTest, ReportsMeansAndExtremesOfAllSteps) {
  const RunReport report = run_in(folder, {});
  double contacts = 0, iterations = 0, converged = 0, cycling = 0, residual = 0;
  for (const StepRecord& s : read_recording(folder / "run.h5").steps) {
    contacts += s.report.contacts;
    iterations += s.report.iterations;
    converged += s.report.converged;
    cycling += s.report.cycling;
    residual = std::max(residual, s.report.residual);
  }
  EXPECT_DOUBLE_EQ(report.contacts_mean, contacts / 100);
  EXPECT_DOUBLE_EQ(report.iterations_mean, iterations / 100);
  EXPECT_DOUBLE_EQ(report.converged_fraction, 0.75);
  EXPECT_DOUBLE_EQ(report.converged_fraction, converged / 100);
  EXPECT_DOUBLE_EQ(report.cycling_fraction, cycling / 100);
  EXPECT_EQ(report.residual_max, residual);
  EXPECT_EQ(report.max_penetration, 2e-6);
  EXPECT_GT(report.wall_s, 0);
}

TEST_F(RunTest, AnInterruptedRunResumesBitForBit) {
  const RunReport whole = run_in(other, {});
  for (const int at : {0, 1, 15, 16, 17, 99, 100}) {
    RunReport part = run_in(folder, interrupt_after(at));
    EXPECT_EQ(part.end, at < 100 ? RunReport::End::interrupted : RunReport::End::done) << at;
    EXPECT_EQ(part.steps, at);
    EXPECT_EQ(read_recording(folder / "run.h5").steps.size(), static_cast<std::size_t>(at));
    const RunReport rest = run_in(folder, {}, true);
    EXPECT_EQ(rest.end, RunReport::End::done);
    EXPECT_EQ(rest.steps, 100);
    EXPECT_EQ(rest.contacts_mean, whole.contacts_mean);
    EXPECT_EQ(rest.residual_max, whole.residual_max);
    EXPECT_GE(rest.wall_s, part.wall_s);
    expect_same_files();
  }
}

TEST_F(RunTest, SeveralInterruptionsAddUp) {
  run_in(other, {});
  run_in(folder, interrupt_after(7));
  for (int k = 0; k < 4; ++k) EXPECT_EQ(run_in(folder, interrupt_after(20), true).end, RunReport::End::interrupted);
  EXPECT_EQ(run_in(folder, interrupt_after(20), true).end, RunReport::End::done);
  expect_same_files();
}

TEST_F(RunTest, FallsBackWhenTheNewestCheckpointIsTruncated) {
  run_in(other, {});
  schedule.checkpoint_wall_s = 0;
  run_in(folder, interrupt_after(40));
  schedule.checkpoint_wall_s = 1e9;
  const auto files = find_checkpoints(folder / "checkpoints");
  ASSERT_EQ(files.size(), 2u);
  write_atomically(files[0], read_bytes(files[0]).substr(0, 2000));
  std::string warning;
  RunHooks hooks;
  hooks.warning = [&](const std::string& text) { warning = text; };
  EXPECT_EQ(run_in(folder, hooks, true).end, RunReport::End::done);
  EXPECT_NE(warning.find(files[0].filename().string()), std::string::npos) << warning;
  expect_same_files();
}

TEST_F(RunTest, WithoutACheckpointItStartsAtTheBeginningAndSaysSo) {
  std::string warning;
  RunHooks hooks;
  hooks.warning = [&](const std::string& text) { warning = text; };
  EXPECT_EQ(run_in(folder, hooks, true).steps, 100);
  EXPECT_NE(warning.find("beginning"), std::string::npos);
}

TEST_F(RunTest, EndsEarlyAndStaysEnded) {
  RunHooks hooks;
  std::vector<double> asked;
  hooks.finished = [&](const Snapshot& state, const StepReport&) {
    asked.push_back(state.time / h);
    return state.time > 40 * h;
  };
  const RunReport report = run_in(folder, hooks);
  EXPECT_EQ(report.end, RunReport::End::stopped);
  EXPECT_EQ(report.steps, 48);
  EXPECT_EQ(asked, (std::vector<double>{16, 32, 48}));
  const std::string bytes = read_bytes(folder / "run.h5");

  const RunReport again = run_in(folder, hooks, true);
  EXPECT_EQ(again.end, RunReport::End::stopped);
  EXPECT_EQ(again.steps, 48);
  EXPECT_TRUE(read_bytes(folder / "run.h5") == bytes);

  RunHooks both = interrupt_after(20);
  both.finished = hooks.finished;
  run_in(other, both);
  EXPECT_EQ(run_in(other, hooks, true).end, RunReport::End::stopped);
  EXPECT_TRUE(read_bytes(other / "run.h5") == bytes);
}

TEST_F(RunTest, ResumingAFinishedRunChangesNothing) {
  run_in(folder, {});
  run_in(other, {});
  EXPECT_EQ(run_in(folder, {}, true).end, RunReport::End::done);
  expect_same_files();
}

TEST_F(RunTest, AStateThatIsNotFiniteFailsAndKeepsWhatCameBefore) {
  FlyingWorld world(model);
  world.explode_at = 40;
  Recorder recorder(folder, model, "text", "fake", 1, false);
  try {
    run(world, model, schedule, &recorder, {});
    FAIL() << "a state that is not finite was accepted";
  } catch (const Error& problem) {
    EXPECT_EQ(problem.kind(), Error::Kind::simulation);
    EXPECT_NE(problem.place().find("step 40"), std::string::npos) << problem.what();
    EXPECT_NE(problem.problem().find("floor"), std::string::npos) << problem.what();
  }
  const Recording r = read_recording(folder / "run.h5");
  EXPECT_EQ(r.steps.size(), 39u);
  EXPECT_EQ(r.frames.size(), 3u);
}

TEST_F(RunTest, RefusesImpossibleSchedules) {
  FlyingWorld world(model);
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  for (const Schedule& bad : {Schedule{0, 1, 1}, Schedule{-h, 1, 1}, Schedule{h, 0, 1}, Schedule{h, nan, 1}, Schedule{h, 1, 0},
                             Schedule{h, infinity, 1}, Schedule{1, 0.4, 1}, Schedule{1e-300, 1, 1}})
    EXPECT_THROW(run(world, model, bad, nullptr, {}), Error);
}

TEST_F(RunTest, TellsProgressAtLeastAtTheEnd) {
  std::vector<Progress> told;
  RunHooks hooks;
  hooks.progress = [&](const Progress& p) { told.push_back(p); };
  run_in(folder, hooks);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.back().step, 100);
  EXPECT_EQ(told.back().steps, 100);
  EXPECT_EQ(told.back().remaining_s, 0);
}

}  // namespace
}  // namespace repose
