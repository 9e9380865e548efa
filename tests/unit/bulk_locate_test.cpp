/// Where bulk observables differ: parts, differences and p by hand.
#include "analysis/diagnosis/bulk_locate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analysis/two_samples.hpp"

namespace repose::diagnosis {
namespace {

using Runs = std::vector<std::vector<Observation>>;

/// Standard scores of five runs.
const std::vector<double> five{-1.2, -0.5, 0, 0.4, 1.3};

Observation named(ObservableKind kind, const char* name) {
  Observation o;
  o.kind = kind;
  o.name = name;
  return o;
}

/// Of this observable, the part that begins here; the first one if nothing does.
const BulkLocated* part_at(const std::vector<BulkLocated>& found, double begins) {
  for (const BulkLocated& l : found)
    if (const double from = l.t_start.value_or(l.radius_from.value_or(NAN)); std::abs(from - begins) < 1e-12) return &l;
  return nullptr;
}

/// A cone of height 1 seen up to a radius of 0.95, higher by `step` in the last third of that; before it came to rest it was `before`.
std::vector<Observation> heap(double noise, double step, double before) {
  Observation o = named(ObservableKind::profile, "heap");
  for (const double time : {1.0, 2.0})
    for (int i = -10; i < 10; ++i) {
      const double x = 0.1 * (i + 0.5), r = std::abs(x);
      o.time.push_back(time);
      o.at.push_back(x);
      // One flank is higher than the other: the mean of both is a cone.
      o.value.push_back(time == 1 ? before : 1 - r + noise + 0.3 * x + (r > 0.64 ? step : 0));
    }
  return {o};
}

TEST(BulkLocateTest, OfAProfileTheLastOneCountsAndBothFlanks) {
  Runs recorded, simulated;
  for (const double z : five) {
    recorded.push_back(heap(0.01 * z, 0.2, 7));
    simulated.push_back(heap(0.01 * z, 0, 0));
  }
  const std::vector<BulkLocated> found = locate_bulk(recorded, simulated);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_NEAR(*found.front().radius_from, 0.95 * 2 / 3, 1e-12);
  EXPECT_NEAR(*found.front().radius_to, 0.95, 1e-12);
  EXPECT_EQ(found.front().phase, "heap");
  EXPECT_NEAR(found.front().difference, 0.2, 1e-12);
  EXPECT_LT(found.front().p, 1e-6);
  for (const double begins : {0.0, 0.95 / 3}) {
    ASSERT_NE(part_at(found, begins), nullptr);
    EXPECT_NEAR(part_at(found, begins)->difference, 0, 1e-12) << begins;
    EXPECT_NEAR(part_at(found, begins)->p, 1, 1e-9) << begins;
  }
}

/// Nothing until 1 s, then a kilogram within `takes`.
std::vector<Observation> flow(double noise, double takes) {
  Observation o = named(ObservableKind::series, "discharged_mass");
  for (int i = 0; i <= 400; ++i) {
    o.time.push_back(0.01 * i);
    o.value.push_back(std::clamp((o.time.back() - 1) / takes, 0.0, 1.0) * (1 + noise));
  }
  return {o};
}

TEST(BulkLocateTest, ASeriesIsPartedWhereItChanges) {
  Runs recorded, simulated;
  for (const double z : five) {
    recorded.push_back(flow(0.01 * z, 1.5));
    simulated.push_back(flow(0.01 * z, 1));
  }
  const std::vector<BulkLocated> found = locate_bulk(recorded, simulated);
  ASSERT_EQ(found.size(), 3u);
  const auto first = std::min_element(found.begin(), found.end(), [](const auto& a, const auto& b) { return *a.t_start < *b.t_start; });
  const auto last = std::max_element(found.begin(), found.end(), [](const auto& a, const auto& b) { return *a.t_end < *b.t_end; });
  EXPECT_NEAR(*first->t_start, 1.02, 1e-9);
  EXPECT_NEAR(*last->t_end, 1.98, 1e-9);
  EXPECT_NEAR(last->difference, -0.82 / 3, 0.01);  // at the middle of the last third, t = 1.82: 0.82 (1 / 1.5 - 1)
  for (const BulkLocated& l : found) EXPECT_EQ(l.phase, "flow");
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.p < b.p; }));
}

std::vector<Observation> angle(double value) {
  Observation o = named(ObservableKind::scalar, "angle_of_repose");
  o.scalar = value;
  return {o};
}

TEST(BulkLocateTest, ASingleRunIsOneMoreOfTheSample) {
  const Runs simulated{angle(20), angle(22), angle(21), angle(23)};
  const std::vector<BulkLocated> found = locate_bulk({angle(27)}, simulated);
  ASSERT_EQ(found.size(), 1u);
  const double sd = std::sqrt(5.0 / 3);
  EXPECT_NEAR(found.front().difference, 5.5, 1e-12);
  EXPECT_NEAR(found.front().in_scatter, 5.5 / sd, 1e-12);
  EXPECT_NEAR(found.front().p, student_two_sided(5.5 / (sd * std::sqrt(1.25)), 3), 1e-12);
  EXPECT_TRUE(locate_bulk({angle(27)}, {angle(20)}).empty());
  EXPECT_TRUE(locate_bulk({}, simulated).empty());
}

TEST(BulkLocateTest, NamesTheRunThatLiesFurthestOff) {
  const std::vector<BulkLocated> found = locate_bulk({angle(21), angle(NAN), angle(12), angle(27)}, {angle(20), angle(22), angle(21), angle(23)});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found.front().run, 2u);
}

TEST(BulkLocateTest, PIsCorrectedForEveryPart) {
  const auto both = [](double first, double second) {
    std::vector<Observation> run = angle(first);
    run.push_back(named(ObservableKind::scalar, "offset"));
    run.back().scalar = second;
    return run;
  };
  Runs recorded, simulated;
  for (const double z : five) {
    recorded.push_back(both(25 + z, z));
    simulated.push_back(both(20 + z, z));
  }
  const std::vector<BulkLocated> found = locate_bulk(recorded, simulated);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found.front().observable, "angle_of_repose");
  std::vector<double> theirs, ours;
  for (const double z : five) {
    theirs.push_back(25 + z);
    ours.push_back(20 + z);
  }
  EXPECT_NEAR(found.front().p, 2 * welch_difference(theirs, ours).p, 1e-12);
}

TEST(BulkLocateTest, ASurfaceIsToldByHeightAndRoughness) {
  const auto surface = [](double height, double roughness) {
    Observation o = named(ObservableKind::surface, "layer_after");
    o.at = o.at_y = {0, 1, 2, 3};
    for (const double z : {-1.0, -1.0, 1.0, 1.0}) o.value.push_back(height + roughness * z);
    return std::vector<Observation>{o};
  };
  Runs recorded, simulated;
  for (const double z : five) {
    recorded.push_back(surface(1 + 0.01 * z, 0.3 + 0.01 * z));
    simulated.push_back(surface(1 + 0.01 * z, 0.1 + 0.01 * z));
  }
  const std::vector<BulkLocated> found = locate_bulk(recorded, simulated);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].quantity, "roughness");
  EXPECT_EQ(found[0].phase, "spread");
  EXPECT_NEAR(found[0].difference, 0.2 * std::sqrt(4.0 / 3), 1e-12);
  EXPECT_EQ(found[1].quantity, "");
  EXPECT_NEAR(found[1].difference, 0, 1e-12);
}

}  // namespace
}  // namespace repose::diagnosis
