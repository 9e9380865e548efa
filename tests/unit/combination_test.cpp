#include <gtest/gtest.h>

#include <Eigen/Core>

#include "analysis/diagnosis/combination.hpp"

namespace repose::diagnosis {
namespace {

using Groups = std::vector<std::vector<std::size_t>>;

/// Information of a record that sees the given linear combinations of its parameters.
Eigen::MatrixXd seen(const Eigen::MatrixXd& rows) { return rows.transpose() * rows; }

TEST(OnlyTogether, ARatioIsOneGroup) {
  Eigen::MatrixXd rows(2, 3);
  rows << 1e3, 0, -1, 0, 5, 0;  // the first and the third in one combination, whatever their units
  EXPECT_EQ(only_together(seen(rows)), (Groups{{0, 2}}));
}

TEST(OnlyTogether, SeparateParametersAreNone) {
  Eigen::MatrixXd rows(3, 2);
  rows << 1, 0.9, 1, 1.1, 1, 1;
  EXPECT_TRUE(only_together(seen(rows)).empty());
}

TEST(OnlyTogether, WhatMovesNothingIsInNoGroup) {
  Eigen::MatrixXd rows(1, 2);
  rows << 2, 0;
  EXPECT_TRUE(only_together(seen(rows)).empty());
  EXPECT_TRUE(only_together(Eigen::MatrixXd(0, 0)).empty());
}

}  // namespace
}  // namespace repose::diagnosis
