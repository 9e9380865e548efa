#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "scenarios/compare_summary.hpp"
#include "scenarios/compare_verdict.hpp"

namespace repose {
namespace {

using nlohmann::json;

/// Runs made up observable by observable: seed s of a contender has the value that `value` says.
class MadeUp {
 public:
  using Value = std::function<double(std::size_t contender, Refinement, std::size_t seed)>;

  MadeUp(std::size_t seeds, const std::map<std::string, Value>& observables) {
    static const Backend engines[] = {{"one", "", nullptr, nullptr}, {"two", "", nullptr, nullptr}};
    c.contenders = {{"one", &engines[0], {}}, {"two", &engines[1], {}}};
    c.seeds = seeds;
    c.random = seeds > 1;
    c.tolerance = 1e-3;
    for (std::size_t k = 0; k < 2; ++k)
      for (Refinement how : refinements) {
        for (std::size_t s = 0; s < seeds; ++s) {
          c.jobs.push_back({c.variants.size(), s, ""});
          json run = {{"observables", json::object()}};
          for (const auto& [name, value] : observables)
            run["observables"][name] = {{"value", value(k, how, s)}, {"unit", "m"}, {"kind", "physics"}, {"scale", 1.0}};
          report.results.push_back(JobResult{run, ""});
        }
        c.variants.push_back({k, how, {}});
      }
  }
  json verdict(const std::string& name) const {
    for (const json& o : compare_verdicts(c, CompareResults(c, report)))
      if (o["name"] == name) return o;
    return nullptr;
  }

  Comparison c;
  JobsReport report;
};

double scatter(std::size_t seed) { return 0.1 * static_cast<double>((7 * seed) % 5); }
double wiggle(std::size_t seed) { return 0.01 * static_cast<double>((3 * seed) % 4); }

TEST(CompareVerdict, EqualRunsAgreeExactly) {
  const MadeUp made(5, {{"x", [](std::size_t, Refinement, std::size_t s) { return scatter(s); }}});
  const json o = made.verdict("x");
  EXPECT_EQ(o["verdict"], "agree");
  EXPECT_EQ(o["standard_errors"], 0);
  EXPECT_NEAR(o["values"]["one"]["mean"].get<double>(), 0.2, 1e-12);
  EXPECT_EQ(o["values"]["one"]["n"], 5);
}

TEST(CompareVerdict, PairsSeeThroughTheScatterOfSeeds) {
  const MadeUp made(5, {{"x", [](std::size_t k, Refinement, std::size_t s) { return scatter(s) + (k == 0 ? 0 : 0.1 + wiggle(s)); }}});
  const json o = made.verdict("x"), &pair = o["pairs"][0];
  EXPECT_EQ(o["verdict"], "differ");
  EXPECT_LT(pair["welch_standard_errors"].get<double>(), 2);
  EXPECT_GT(o["standard_errors"].get<double>(), 15);
  EXPECT_NEAR(pair["half_width_95"].get<double>(), 2.776445 * pair["se"].get<double>(), 1e-6);  // Student, 4 degrees of freedom
  EXPECT_TRUE(pair["explained_by"].empty());
  EXPECT_NE(o["text"].get<std::string>().find("Not a matter of step or tolerance"), std::string::npos);
}

TEST(CompareVerdict, ADifferenceThatTheStepMakesIsBlamedOnTheStep) {
  const MadeUp made(5, {{"x", [](std::size_t k, Refinement how, std::size_t s) {
                           return scatter(s) + (k == 1 && how != Refinement::half_step ? 0.1 + wiggle(s) : 0);
                         }}});
  const json o = made.verdict("x"), &pair = o["pairs"][0];
  EXPECT_EQ(o["verdict"], "differ");
  ASSERT_EQ(pair["explained_by"].size(), 1u);
  EXPECT_EQ(pair["explained_by"][0]["backend"], "two");
  EXPECT_EQ(pair["explained_by"][0]["refinement"], "half_step");
  EXPECT_EQ(pair["refined"]["half_step"]["difference"], 0);
  EXPECT_NE(o["text"].get<std::string>().find("two is not converged in h"), std::string::npos);
}

TEST(CompareVerdict, ManyObservablesAreCorrectedFor) {
  // t = 3.6 with four degrees of freedom: p = 0.02 alone, 1 among a hundred.
  const auto slight = [](std::size_t k, Refinement, std::size_t s) { return scatter(s) + (k == 1 ? 0.01 + 0.0062 * (static_cast<double>(s) - 2) / 1.58 : 0); };
  EXPECT_EQ(MadeUp(5, {{"x", slight}}).verdict("x")["verdict"], "differ");
  std::map<std::string, MadeUp::Value> many{{"x", slight}};
  for (int i = 0; i < 99; ++i) many[std::string("y").append(std::to_string(i))] = [](std::size_t, Refinement, std::size_t s) { return scatter(s); };
  EXPECT_EQ(MadeUp(5, many).verdict("x")["verdict"], "agree");
}

TEST(CompareVerdict, WithoutScatterTheToleranceDecides) {
  const auto off_by = [](double d) {
    return MadeUp(1, {{"x", [d](std::size_t k, Refinement, std::size_t) { return 1 + (k == 1 ? d : 0); }}}).verdict("x");
  };
  EXPECT_EQ(off_by(0.9e-3)["verdict"], "agree");
  EXPECT_EQ(off_by(1.1e-3)["verdict"], "differ");
  EXPECT_TRUE(off_by(1.1e-3)["standard_errors"].is_null());
}

TEST(CompareVerdict, FailedRunsAreLeftOutOnBothSides) {
  MadeUp made(5, {{"x", [](std::size_t, Refinement, std::size_t s) { return scatter(s); }}});
  made.report.results[2] = JobResult{json::object(), "it blew up"};
  const json o = made.verdict("x");
  EXPECT_EQ(o["pairs"][0]["n"], 4);
  EXPECT_EQ(o["verdict"], "agree");
  EXPECT_EQ(CompareResults(made.c, made.report).failed(0), 1u);
}

}  // namespace
}  // namespace repose
