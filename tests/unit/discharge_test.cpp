#include "analysis/discharge.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "analysis/rest.hpp"
#include "core/error.hpp"
#include "tests/unit/synthetic_heap.hpp"

namespace repose {
namespace {

TEST(Discharge, MassBelowThePlane) {
  synthetic::Heap heap = synthetic::empty_heap(5);
  synthetic::add_sphere(heap, Vec3(0, 0, 1), 0.5);
  synthetic::add_sphere(heap, Vec3(0, 0, 3), 0.5);
  EXPECT_DOUBLE_EQ(mass_below(heap.model, heap.state, 2), heap.model.bodies[0].mass);
  heap.state.position.pop_back();
  EXPECT_THROW(mass_below(heap.model, heap.state, 2), Error);
}

TEST(Discharge, SteadyRateLeavesStartAndEndOut) {
  DischargeCurve curve;
  for (int i = 0; i <= 100; ++i) {
    curve.time.push_back(0.01 * i);
    curve.mass.push_back(i < 20 ? 1 : i > 80 ? 7 : 1 + 0.1 * (i - 20));  // 0, then 10 kg/s, then 0
  }
  const auto rate = steady_rate(curve);
  ASSERT_TRUE(rate);
  EXPECT_NEAR(rate->rate, 10, 1e-9);
  EXPECT_NEAR(rate->discharged, 6, 1e-12);
  EXPECT_NEAR(rate->from, 0.32, 0.011);
  EXPECT_NEAR(rate->to, 0.68, 0.011);
}

TEST(Discharge, NoFlowNoRate) {
  EXPECT_FALSE(steady_rate({}));
  EXPECT_FALSE(steady_rate({{0, 1, 2}, {1, 1, 1}}));
  EXPECT_FALSE(steady_rate({{0, 1, 2}, {0, 1, 2}}));
}

TEST(Discharge, Beverloo) {
  // 0.58 * 600 * sqrt(9.81) * (0.01 - 1.4e-3)^2.5
  EXPECT_NEAR(beverloo_rate(600, 9.81, 0.01, 1e-3), 0.58 * 600 * 3.132091952673165 * std::pow(8.6e-3, 2.5), 1e-12);
  EXPECT_EQ(beverloo_rate(600, 9.81, 1e-3, 1e-3), 0);
  EXPECT_THROW(beverloo_rate(-1, 9.81, 1, 0.1), Error);
}

TEST(Discharge, OutletComesFromTheFunnel) {
  Scene scene;
  EXPECT_FALSE(funnel_outlet(scene));
  Tool tool;
  Funnel funnel;
  funnel.outlet_diameter = 0.6e-3;
  funnel.opens = 0.04;
  tool.kind = funnel;
  tool.position = Vec3(0, 0, 1.5e-3);
  scene.tools = {tool};
  const auto outlet = funnel_outlet(scene);
  ASSERT_TRUE(outlet);
  EXPECT_EQ(outlet->height, 1.5e-3);
  EXPECT_EQ(outlet->diameter, 0.6e-3);
  EXPECT_EQ(outlet->opens, 0.04);
}

struct Resting : ::testing::Test {
  synthetic::Heap heap = synthetic::empty_heap(5);
  Outlet outlet{10, 2, 1};
  void SetUp() override {
    for (int i = -3; i <= 3; ++i) synthetic::add_sphere(heap, Vec3(i, 0, 0.5), 0.5);
    heap.state.time = 2;
  }
  RestReport assess() { return assess_rest(heap.model, heap.state, heap.site, outlet); }
};

TEST_F(Resting, StillHeapRests) {
  const RestReport r = assess();
  EXPECT_TRUE(r.at_rest) << r.reason;
  EXPECT_DOUBLE_EQ(r.speed_scale, std::sqrt(9.81));
}

TEST_F(Resting, ClosedFunnelFallingGrainAndMotionDoNot) {
  heap.state.time = 0.5;
  EXPECT_FALSE(assess().at_rest);
  heap.state.time = 2;
  heap.state.velocity[2] = Vec3(0.06 * std::sqrt(9.81), 0, 0);
  EXPECT_FALSE(assess().at_rest);
  EXPECT_NEAR(assess().speed_max, 0.06, 1e-12);
  heap.state.velocity[2].setZero();
  synthetic::add_sphere(heap, Vec3(0, 0, 6), 0.5);
  EXPECT_EQ(assess().falling, 1u);
  EXPECT_FALSE(assess().at_rest);
  heap.state.position.back().z() = 12;  // stuck in the funnel: the heap rests all the same
  EXPECT_TRUE(assess().at_rest);
  EXPECT_EQ(assess().in_funnel, 1u);
  heap.state.velocity.back() = Vec3(0, 0, -1);
  EXPECT_FALSE(assess().at_rest);
}

TEST_F(Resting, CreepIsSeenByTheMean) {
  for (Vec3& v : heap.state.velocity) v = Vec3(0.02 * std::sqrt(9.81), 0, 0);
  EXPECT_FALSE(assess().at_rest);
  EXPECT_NEAR(assess().speed_rms, 0.02, 1e-12);
}

TEST_F(Resting, DisplacementBetweenStates) {
  Snapshot later = heap.state;
  later.time = 2.5;
  later.position[1].x() += 0.07;
  const HeapGrains grains = find_heap(heap.model, heap.state, heap.site);
  const Displacement moved = heap_displacement(heap.state, later, grains);
  EXPECT_NEAR(moved.max, 0.07, 1e-12);
  EXPECT_NEAR(moved.rms, 0.07 / std::sqrt(7), 1e-12);
  EXPECT_EQ(moved.interval, 0.5);
  later.position.pop_back();
  EXPECT_THROW(heap_displacement(heap.state, later, grains), Error);
}

}  // namespace
}  // namespace repose
