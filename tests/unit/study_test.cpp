#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <fstream>

#include "analysis/reference.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "scenarios/jobs.hpp"
#include "scenarios/study_plan.hpp"
#include "scenarios/study_summary.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "repose-study-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~Folder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

constexpr const char* plan_text = R"(
title: test
scene: heap.yaml
seeds: 3
first_seed: 5
set: {grains.powder.count: 100}
series:
  curve:
    label: a curve
    reference: set/table.yaml
    vary:
      - {a.rho: [0.05, 0.1], a.sigma: [0.05, 0.1]}
  crossed:
    seeds: 1
    set: {grains.powder.aspect: 1.2}
    vary:
      - {a.rho: [1, 2]}
      - {a.mu: [3, 4, 5]}
  single:
    scene: other.yaml
    points: [{label: sliding only, set: {a.rho: 0}}, {set: {a.kind: fast}}]
)";

TEST(StudyPlan, ListsGoTogetherAndMapsAreCrossed) {
  const StudyPlan plan = parse_study(plan_text, "study.yaml", "/somewhere");
  EXPECT_EQ(plan.points[0].scene, fs::path("/somewhere/heap.yaml"));
  ASSERT_EQ(plan.points.size(), 2u + 6u + 2u);
  EXPECT_EQ(plan.series[0].x_key, "a.rho");
  const StudyPoint& second = plan.points[1];
  EXPECT_EQ(second.x, 0.1);
  EXPECT_EQ(second.seeds, 3);
  ASSERT_EQ(second.set.size(), 3u);
  EXPECT_EQ(second.set[0].path, "grains.powder.count");
  EXPECT_EQ(second.set[2].path, "a.sigma");
  EXPECT_EQ(second.set[2].value, "0.1");
  EXPECT_EQ(plan.points[4].set.back().value, "5");
  EXPECT_EQ(plan.points[5].set.back().value, "3");
  EXPECT_EQ(plan.points[4].seeds, 1);
  EXPECT_EQ(plan.points[9].scene, fs::path("/somewhere/other.yaml"));
  EXPECT_EQ(plan.points[8].label, "sliding only");
  EXPECT_FALSE(plan.points[8].x);
  EXPECT_EQ(plan.points[9].label, "kind fast");
}

TEST(StudyPlan, ValuesMayHaveUnits) {
  const StudyPlan plan = parse_study("scene: a\nseries: {gaps: {vary: [{layer.gap: [60 um, 1.2e2 um]}]}, kinds: {vary: [{layer.rotation: [none, rolling]}]}}\n",
                                     "study.yaml", ".");
  EXPECT_EQ(plan.series[0].x_unit, "um");
  EXPECT_EQ(plan.points[0].x, 60);
  EXPECT_EQ(plan.points[1].x, 120);
  EXPECT_EQ(plan.points[1].set.back().value, "1.2e2 um");
  EXPECT_EQ(plan.series[1].x_unit, "");
  EXPECT_FALSE(plan.points[2].x);
  EXPECT_THROW(parse_study("scene: a\nseries: {gaps: {vary: [{layer.gap: [60 um, 0.1 mm]}]}}\n", "study.yaml", "."), Error);
}

TEST(StudyPlan, ErrorsNameThePlace) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      parse_study(text, "study.yaml", ".");
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message("scene: a\nserie: {}\n").find("series"), std::string::npos);
  EXPECT_NE(message("scene: a\nseries: {a: {vary: [{x: [1, 2], y: [1]}]}}\n").find("study.yaml:2"), std::string::npos);
  EXPECT_NE(message("scene: a\nseries: {a: {vary: []}}\n"), "");
  EXPECT_NE(message("scene: a\nseries: {a: {vary: 3}}\n"), "");
  EXPECT_NE(message("scene: a\nseries: {}\n"), "");
  EXPECT_NE(message("scene: a\nseeds: 0\nseries: {a: {}}\n"), "");
  EXPECT_NE(message("scene: a\nseeds: 1000000\nseries: {a: {}}\n"), "");
  EXPECT_NE(message("series: {a: {}}\n"), "");
  EXPECT_THROW(load_study("/nowhere/study.yaml"), Error);
}

std::vector<Scene> scenes(int count) {
  std::vector<Scene> result(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) result[static_cast<std::size_t>(i)].text = "scene " + std::to_string(i);
  return result;
}

std::vector<Job> jobs_of(const std::vector<Scene>& list, int seeds) {
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < list.size(); ++i)
    for (int s = 0; s < seeds; ++s) {
      const std::uint64_t seed = static_cast<std::uint64_t>(s);
      jobs.push_back({i, seed, job_key(list[i].text, seed, "dvi", "1")});
    }
  return jobs;
}

TEST(StudyJobs, RunOnceThenReused) {
  const Folder folder;
  const auto list = scenes(3);
  const auto jobs = jobs_of(list, 4);
  std::atomic<int> runs{0};
  const SimulateJob simulate = [&](const Job& job) -> std::optional<json> {
    ++runs;
    return json{{"text", list[job.scene].text}, {"value", job.seed}};
  };
  const JobsReport first = run_jobs(jobs, folder.path(), 2, simulate, {});
  EXPECT_EQ(runs, 12);
  EXPECT_FALSE(first.interrupted);
  const JobsReport second = run_jobs(jobs, folder.path(), 2, simulate, {});
  EXPECT_EQ(runs, 12);
  EXPECT_EQ(second.progress.reused, 12u);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    ASSERT_TRUE(second.results[i]);
    EXPECT_EQ(second.results[i]->observables, first.results[i]->observables);
    EXPECT_EQ(second.results[i]->observables["value"], jobs[i].seed);
  }
  // A damaged file is run again.
  std::ofstream(folder.path() / "jobs" / (jobs[5].key + ".json")) << "{\"key\": ";
  run_jobs(jobs, folder.path(), 1, simulate, {});
  EXPECT_EQ(runs, 13);
}

TEST(StudyJobs, KeysTellRunsApart) {
  EXPECT_NE(job_key("a", 1, "dvi", "1"), job_key("a", 2, "dvi", "1"));
  EXPECT_NE(job_key("a", 1, "dvi", "1"), job_key("b", 1, "dvi", "1"));
  EXPECT_NE(job_key("a", 1, "dvi", "1"), job_key("a", 1, "bullet", "1"));
  EXPECT_NE(job_key("a", 1, "dvi", "1"), job_key("a", 1, "dvi", "2"));
  EXPECT_EQ(job_key("a", 1, "dvi", "1"), job_key("a", 1, "dvi", "1"));
}

TEST(StudyJobs, EqualKeysRunOnce) {
  const Folder folder;
  const auto list = scenes(1);
  auto jobs = jobs_of(list, 1);
  jobs.push_back(jobs[0]);
  std::atomic<int> runs{0};
  const JobsReport report = run_jobs(jobs, folder.path(), 2, [&](const Job&) -> std::optional<json> {
    ++runs;
    return json{{"value", 1}};
  }, {});
  EXPECT_EQ(runs, 1);
  EXPECT_TRUE(report.results[0] && report.results[1]);
}

TEST(StudyJobs, FailuresAreReportedAndTriedAgain) {
  const Folder folder;
  const auto list = scenes(2);
  const auto jobs = jobs_of(list, 1);
  bool broken = true;
  const SimulateJob simulate = [&](const Job& job) -> std::optional<json> {
    if (broken && list[job.scene].text == "scene 1") throw Error("step 3", "diverged", "smaller step", Error::Kind::simulation);
    return json{{"value", 1}};
  };
  const JobsReport first = run_jobs(jobs, folder.path(), 1, simulate, {});
  EXPECT_EQ(first.progress.failed, 1u);
  EXPECT_NE(first.results[1]->failure.find("diverged"), std::string::npos);
  broken = false;
  EXPECT_EQ(run_jobs(jobs, folder.path(), 1, simulate, {}).progress.failed, 0u);
}

TEST(StudyJobs, WrongInputEndsTheStudy) {
  const Folder folder;
  const auto list = scenes(2);
  EXPECT_THROW(run_jobs(jobs_of(list, 2), folder.path(), 2,
                        [](const Job&) -> std::optional<json> { throw Error("a", "b", "c"); }, {}),
               Error);
  EXPECT_THROW(run_jobs({}, folder.path(), 0, {}, {}), Error);
}

TEST(StudyJobs, InterruptKeepsWhatIsDone) {
  const Folder folder;
  const auto list = scenes(5);
  const auto jobs = jobs_of(list, 1);
  std::atomic<int> runs{0};
  std::atomic<bool> stop{false};
  const SimulateJob simulate = [&](const Job&) -> std::optional<json> {
    if (++runs == 3) {
      stop = true;
      return std::nullopt;
    }
    if (stop) return std::nullopt;
    return json{{"value", 1}};
  };
  JobsHooks hooks;
  hooks.interrupted = [&] { return stop.load(); };
  const JobsReport report = run_jobs(jobs, folder.path(), 1, simulate, hooks);
  EXPECT_TRUE(report.interrupted || report.progress.done == 2);
  EXPECT_EQ(report.progress.done, 2u);
  stop = false;
  runs = 10;
  EXPECT_EQ(run_jobs(jobs, folder.path(), 1, simulate, {}).progress.done, 5u);
}

TEST(StudySummary, HandAnswer) {
  const StudyPlan plan = parse_study(plan_text, "study.yaml", ".");
  std::vector<Job> jobs;
  JobsReport report;
  for (std::size_t p = 0; p < plan.points.size(); ++p)
    for (int s = 0; s < plan.points[p].seeds; ++s) {
      jobs.push_back({p, static_cast<std::uint64_t>(s), "k"});
      // Angle 30 + 60 rho + (-1, 0, 1) over seeds.
      const double angle = 30 + 60 * plan.points[p].x.value_or(0) + (plan.points[p].seeds == 3 ? s - 1 : 0);
      report.results.push_back(JobResult{{{"angle_of_repose", angle}, {"sd_azimuth", 1.0 + s}, {"at_rest", s == 2 ? 0 : 1}, {"solid_fraction", nullptr}}, ""});
    }
  report.results[0] = JobResult{json::object(), "it diverged"};
  report.results.back().reset();
  ReferenceSet reference;
  reference.title = "table";
  for (double x : {0.05, 0.075, 0.1}) reference.values.push_back({"angle_of_repose", x, 30 + 70 * x, 1.0, "deg"});
  const json out = summarise_study(plan, jobs, report, {{"set/table.yaml", reference}}, {"angle_of_repose", "sd_azimuth"});
  const json& first = out["points"][0];
  EXPECT_EQ(first["runs"], 2);
  EXPECT_EQ(first["failed"], 1);
  EXPECT_EQ(first["not_at_rest"], 1);
  EXPECT_EQ(first["set"]["grains.powder.count"], 100);
  const json& angle = first["observables"]["angle_of_repose"];
  EXPECT_EQ(angle["n"], 2);
  EXPECT_NEAR(angle["mean"].get<double>(), 33.5, 1e-12);
  EXPECT_NEAR(angle["sd_seed"].get<double>(), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(angle["se"].get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(angle["sd_azimuth"].get<double>(), 2.5, 1e-12);
  EXPECT_FALSE(first["observables"].contains("solid_fraction"));
  EXPECT_EQ(out["points"].back()["missing"], 1);
  const json& series = out["series"][0];
  EXPECT_NEAR(series["slope"]["value"].get<double>(), (36 - 33.5) / 0.05, 1e-9);
  EXPECT_NEAR(series["reference"]["slope"]["value"].get<double>(), 70, 1e-9);
  ASSERT_EQ(series["reference"]["differences"].size(), 2u);
  EXPECT_NEAR(series["reference"]["differences"][1]["difference"].get<double>(), -1, 1e-9);
  EXPECT_TRUE(series["reference"]["differences"][0]["within_uncertainty"].get<bool>());
  EXPECT_FALSE(out["series"][2].contains("slope"));
}

TEST(Reference, FilesOfTheSourceStudy) {
  const fs::path folder = REPOSE_REFERENCE_DIR;
  const ReferenceSet table = load_reference(folder / "pa650/table2.yaml");
  const auto curve = table.curve("angle_of_repose");
  ASSERT_EQ(curve.size(), 4u);
  EXPECT_EQ(curve[0].value, 31.12);
  const auto line = reference_line(curve);
  ASSERT_TRUE(line);
  EXPECT_NEAR(line->slope, 73.5, 0.05);
  EXPECT_NEAR(line->slope_se, 8.4, 0.05);
  EXPECT_EQ(load_reference(folder / "pa650/table1.yaml").single("angle_of_repose")->value, 32.93);
  EXPECT_NEAR(load_reference(folder / "pa650/powder.yaml").single("solid_fraction")->value, 460.0 / 1020, 1e-3);
  EXPECT_THROW(load_reference(folder / "nothing.yaml"), Error);
}

}  // namespace
}  // namespace repose
