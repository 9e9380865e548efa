#include "backends/dvi/lanes.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace repose::dvi {
namespace {

template <class Real>
class LanesTest : public ::testing::Test {
 protected:
  static constexpr int lanes = lane_count<Real>;
  static constexpr std::int32_t bodies = 40;

  LanesTest() {
    for (std::size_t i = 0; i < records.size(); ++i) records[i] = static_cast<Real>(i);
    for (int l = 0; l < lanes; ++l) index[l] = (7 * l + 3) % bodies;  // all different
  }
  Real number(int lane, int k) const { return records[static_cast<std::size_t>(record_size * index[lane] + k)]; }

  std::vector<Real> records = std::vector<Real>(record_size * bodies);
  std::int32_t index[lanes] = {};
  Lanes<Real> column[record_size] = {};
};

using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(LanesTest, Reals);

TYPED_TEST(LanesTest, ColumnsHoldTheNumbersOfEveryLanesRecord) {
  load_records<TypeParam>(this->records.data(), this->index, this->column);
  for (int k = 0; k < record_size; ++k)
    for (int l = 0; l < this->lanes; ++l) EXPECT_EQ(this->column[k][l], this->number(l, k)) << "number " << k << " of lane " << l;
}

TYPED_TEST(LanesTest, RecordsAreWrittenBelowTheLimitAlone) {
  const std::vector<TypeParam> before = this->records;
  load_records<TypeParam>(this->records.data(), this->index, this->column);
  for (Lanes<TypeParam>& c : this->column) c += 1000;
  const std::int32_t limit = this->index[0] + 1;
  store_records<TypeParam>(this->records.data(), limit, this->index, this->column);
  for (std::int32_t body = 0; body < this->bodies; ++body) {
    bool written = false;
    for (int l = 0; l < this->lanes; ++l) written |= this->index[l] == body && body < limit;
    for (int k = 0; k < record_size; ++k) {
      const auto i = static_cast<std::size_t>(record_size * body + k);
      EXPECT_EQ(this->records[i], before[i] + (written ? 1000 : 0)) << "number " << k << " of body " << body;
    }
  }
}

TYPED_TEST(LanesTest, TransposingTwiceChangesNothing) {
  load_records<TypeParam>(this->records.data(), this->index, this->column);
  Lanes<TypeParam> twice[record_size];
  for (int k = 0; k < record_size; ++k) twice[k] = this->column[k];
  transpose<TypeParam>(twice);
  transpose<TypeParam>(twice);
  for (int k = 0; k < record_size; ++k)
    for (int l = 0; l < this->lanes; ++l) EXPECT_EQ(twice[k][l], this->column[k][l]);
}

}  // namespace
}  // namespace repose::dvi
