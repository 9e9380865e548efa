/// Beds without side walls: their properties do not depend on the width of the cell.
#include <cmath>
#include <numeric>
#include <vector>

#include "analysis/packing.hpp"
#include "analysis/statistics.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class PeriodicBed : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(PeriodicBed);

constexpr double d = 0.02, g = 9.81;
constexpr int per_column = 9;  // balls over each square of d x d

struct Bed {
  double fraction = 0, contacts = 0;
};

/// Poured into a cell of 6 d along x and `wide` d along y.
Bed pour(const std::string& backend, int wide, unsigned seed) {
  const int count = per_column * 6 * wide;
  ModelBuilder builder;
  builder.material("ball", 1000).material("floor");
  builder.law("ball", "ball", {.friction = 0.5}).law("ball", "floor", {.friction = 0.5});
  builder.periodic(0, 0, 6 * d).periodic(1, 0, wide * d).floor("floor");
  FillRegion region;
  region.upper = {6 * d, wide * d, 5 * d};
  const std::vector<double> radii(static_cast<std::size_t>(count), 0.5 * d);
  const Shape ball = make_grain_shape("sphere");
  for (const Placement& at : place_balls(region, radii, seed, {Vec3::Zero(), {6 * d, wide * d, 0}}))
    builder.body("ball", ball, {.position = at.position}, d).as_grain();
  const Model model = builder.build();
  Simulation s(backend, model, usual(2e-3, 1e-4));
  s.run(700);

  double top = 0;
  std::vector<int> balls(static_cast<std::size_t>(count)), carrying(model.bodies.size(), 0);
  std::iota(balls.begin(), balls.end(), 1);
  for (const int i : balls) top += 2 * s.position(i).z() / count;
  const double weight = model.bodies.back().mass * g;
  for (const Contact& c : s.contacts())
    if (c.force.norm() > 1e-2 * weight) ++carrying[static_cast<std::size_t>(c.a)], ++carrying[static_cast<std::size_t>(c.b)];
  // A cylinder much wider than the cell meets all of it, image by image, equally often (its rim counts 2 % of it).
  Bed bed;
  bed.fraction = solid_fraction_in_cylinder(model, s.state(), balls, {0, 0, 1.5 * d}, 100 * d, top - 3 * d, 40000).value;
  int inner = 0;
  for (const int i : balls)
    if (s.position(i).z() > 1.5 * d && s.position(i).z() < top - 1.5 * d)
      bed.contacts += carrying[static_cast<std::size_t>(i)], ++inner;
  bed.contacts /= inner;
  return bed;
}

TEST_P(PeriodicBed, TwiceTheWidthIsTheSameBed) {
  if (!find_backend(GetParam()).unsupported(ModelBuilder().material("m").periodic(1, 0, 1).sphere("m", 0.1).build()).empty())
    GTEST_SKIP() << GetParam() << " has no periodic cells";
  std::vector<double> fraction[2], contacts[2];
  for (int width = 0; width < 2; ++width)
    for (unsigned seed = 1; seed <= 4; ++seed) {
      const Bed bed = pour(GetParam(), width == 0 ? 5 : 10, seed);
      fraction[width].push_back(bed.fraction);
      contacts[width].push_back(bed.contacts);
    }
  const auto compare = [](const std::string& what, const std::vector<double>(&x)[2]) {
    const Summary narrow = summarise(x[0]), wide = summarise(x[1]);
    const double se = std::hypot(narrow.se, wide.se);
    note("periodic bed, " + what + ", 5 d wide", narrow.mean);
    note("periodic bed, " + what + ", 10 d wide", wide.mean);
    note("periodic bed, " + what + ", difference / standard error", (wide.mean - narrow.mean) / se);
    // Four seeds each: three standard errors are exceeded by chance in 2.4 % (Student, 6 degrees of freedom).
    EXPECT_LE(std::abs(wide.mean - narrow.mean), 3 * se) << what;
    EXPECT_LT(se, 0.05 * narrow.mean) << what << ": the test must be able to see a difference";
  };
  compare("volume fraction", fraction);
  compare("contacts per ball", contacts);
}

}  // namespace
}  // namespace repose::test
