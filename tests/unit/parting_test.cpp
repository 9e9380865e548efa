#include "analysis/parting.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/error.hpp"

namespace repose {
namespace {

constexpr std::size_t cells = 12, frames = 20;
const std::vector<int> kinds{0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1};

// Each cell drifts at random, so frames depend on each other; cells of kind 1 are a thousand times as large, cell 0 is empty.
Film noise(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Film film(cells * frames, 0);
  for (std::size_t c = 1; c < cells; ++c) {
    double x = 0;
    for (std::size_t f = 0; f < frames; ++f) film[f * cells + c] = x = 0.8 * x + (kinds[c] ? 1000 : 1) * normal(random);
  }
  return film;
}

std::vector<Film> ensemble(std::mt19937_64& random, int runs) {
  std::vector<Film> list;
  for (int i = 0; i < runs; ++i) list.push_back(noise(random));
  return list;
}

void shift(std::vector<Film>& list, std::size_t cell, std::size_t from, double by) {
  for (Film& film : list)
    for (std::size_t f = from; f < frames; ++f) film[f * cells + cell] += by;
}

TEST(Parting, FalseAlarmsAreAsRareAsStated) {
  std::mt19937_64 random(5);
  int alarms = 0;
  const int trials = 300;
  for (int k = 0; k < trials; ++k) {
    const auto a = ensemble(random, 5), b = ensemble(random, 5);
    alarms += first_parting(a, b, kinds).first.has_value();
  }
  // At most 12 of 252 ways: 4.8 %; 14.3 of 300, standard deviation 3.7.
  EXPECT_LE(alarms, 29);
  EXPECT_GE(alarms, 3);
}

TEST(Parting, FindsTheFrameAndTheCell) {
  std::mt19937_64 random(7);
  int right = 0;
  for (int k = 0; k < 20; ++k) {
    auto a = ensemble(random, 5);
    const auto b = ensemble(random, 5);
    shift(a, 4, 11, 30);
    const Parting parting = first_parting(a, b, kinds);
    ASSERT_TRUE(parting.first);
    right += parting.first->frame == 11 && parting.first->cell == 4;
    EXPECT_LE(parting.first->p, 0.05);
  }
  EXPECT_GE(right, 19);
}

TEST(Parting, BothKindsOfCellsCount) {
  std::mt19937_64 random(8);
  auto a = ensemble(random, 5);
  const auto b = ensemble(random, 5);
  shift(a, 9, 3, 30000);
  const Parting parting = first_parting(a, b, kinds);
  ASSERT_TRUE(parting.first);
  EXPECT_EQ(parting.first->cell, 9u);
  EXPECT_EQ(parting.first->frame, 3u);
  EXPECT_NEAR(parting.first->mean_a - parting.first->mean_b, 30000, 6 * parting.first->se);
}

TEST(Parting, TheSameRunsNeverPart) {
  std::mt19937_64 random(9);
  const auto a = ensemble(random, 4);
  const Parting parting = first_parting(a, a, kinds);
  EXPECT_FALSE(parting.first);
  EXPECT_EQ(parting.largest.statistic, 0);
  EXPECT_EQ(parting.ways, 70u);
  EXPECT_NEAR(parting.least_p, 2.0 / 70, 1e-15);
}

TEST(Parting, ManyRunsAreDealtAtRandom) {
  std::mt19937_64 random(10);
  auto a = ensemble(random, 9);
  const auto b = ensemble(random, 9);
  EXPECT_EQ(first_parting(a, b, kinds).ways, 2000u);
  shift(a, 4, 11, 20);
  EXPECT_EQ(first_parting(a, b, kinds).first.value().frame, 11u);
}

TEST(Parting, BadFilms) {
  std::mt19937_64 random(1);
  auto a = ensemble(random, 3);
  const auto b = ensemble(random, 3);
  EXPECT_THROW(first_parting(a, std::vector<Film>(1), kinds), Error);
  EXPECT_THROW(first_parting(a, b, kinds, 0), Error);
  a[1].pop_back();
  EXPECT_THROW(first_parting(a, b, kinds), Error);
}

}  // namespace
}  // namespace repose
