/// The search for contacts that keeps those of bodies that stand, against the same search of them all.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "backends/dvi/contact_finder.hpp"
#include "core/grain_shape.hpp"
#include "core/random.hpp"
#include "tests/support/model_builder.hpp"

namespace repose::dvi {
namespace {

/// Grains of all shapes on a floor and between walls, at rest, in a cell that repeats along x; many touch.
class Pile {
 public:
  Pile() : model_(made()), n_(model_.bodies.size()), still_(n_, Vec3::Zero()), turning_(n_, 0.0), present_(n_, 1), position_(model_.initial.position) {
    for (const Quat& q : model_.initial.orientation) rotation_.push_back(q.toRotationMatrix());
  }

  const Model& model() const { return model_; }
  BodyPlacement placement() const { return {position_, rotation_, still_, still_, turning_, present_}; }

  /// Moves and turns some of the grains. Returns which.
  std::vector<char> disturb(double share, Random& random) {
    std::vector<char> moved(n_, 0);
    for (std::size_t i = 0; i < n_; ++i) {
      if (!model_.bodies[i].dynamic || random.uniform() >= share) continue;
      moved[i] = 1;
      position_[i] += 0.05 * (random.rotation() * Vec3::UnitX());
      rotation_[i] = random.rotation().toRotationMatrix();
    }
    return moved;
  }

  std::vector<char> lift_floor(double by) {
    std::vector<char> moved(n_, 0);
    moved[0] = 1;
    position_[0].z() += by;
    return moved;
  }

 private:
  static Model made() {
    test::ModelBuilder builder;
    builder.material("m").floor("m").floor("m", {0, 1, 0}, {0, 0, 0}).floor("m", {0, -1, 0}, {0, 9, 0}).periodic(0, 0, 9);
    Random random(11, 0);
    const std::vector<std::string> names = grain_shape_names();
    for (int i = 0; i < 900; ++i) {
      const Vec3 place(random.uniform(0, 9), random.uniform(0, 9), random.uniform(0.3, 6));
      const Shape shape = make_grain_shape(names[random.below(names.size())]);
      builder.body("m", shape, {.position = place, .orientation = random.rotation()}, random.uniform(0.3, 0.8));
    }
    return builder.build();
  }

  Model model_;
  std::size_t n_;
  std::vector<Vec3> still_;
  std::vector<double> turning_;
  std::vector<char> present_;
  std::vector<Vec3> position_;
  std::vector<Mat3> rotation_;
};

void expect_same(const std::vector<FoundContact>& found, const std::vector<FoundContact>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].id, expected[i].id);
    EXPECT_EQ(found[i].point.gap, expected[i].point.gap);
    EXPECT_EQ(found[i].point.point, expected[i].point.point);
    EXPECT_EQ(found[i].point.normal, expected[i].point.normal);
  }
}

TEST(ContactFinder, KeepsTheContactsOfBodiesThatStandAsASearchOfAllFindsThem) {
  Pile pile;
  Random random(2, 0);
  ContactFinder keeping(pile.model(), 1), searching(pile.model(), 1);
  for (int step = 0; step < 2; ++step) {
    keeping.find(pile.placement(), 0.1, 1, 2);
    searching.find(pile.placement(), 0.1, 1, 1);
    std::vector<char> moved;  // at first all
    std::vector<std::size_t> contacts;
    for (const double share : {0.1, 0.02, 0.0, 0.5, 1.0, 0.0}) {
      const std::vector<FoundContact>& kept = keeping.find_again(pile.placement(), moved, 2);
      contacts.push_back(kept.size());
      expect_same(kept, searching.find_again(pile.placement(), {}, 1));
      moved = pile.disturb(share, random);
    }
    EXPECT_GT(contacts.front(), 300u);
    EXPECT_NE(contacts[1], contacts[0]);
    EXPECT_EQ(contacts[3], contacts[2]) << "nothing had moved";
    moved = pile.lift_floor(0.05);
    const std::size_t before = keeping.find_again(pile.placement(), moved, 2).size();
    expect_same(keeping.find_again(pile.placement(), moved, 2), searching.find_again(pile.placement(), {}, 1));
    EXPECT_NE(before, contacts.back());
  }
}

}  // namespace
}  // namespace repose::dvi
