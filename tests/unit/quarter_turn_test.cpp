#include "analysis/diagnosis/quarter_turn.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <variant>

#include "tests/unit/flight_bundle.hpp"

namespace repose::diagnosis {
namespace {

/// A body that slides on the plane under the scene's friction, from where the flights start.
History slide(const SimulationRequest& request) {
  History history = fly(request);
  const Scene& scene = *request.scene;
  const double mu = scene.pairs.begin()->second.friction;
  AnisotropicFriction law;
  for (const ContactEffect& effect : scene.contact_effects)
    if (const auto* found = std::get_if<AnisotropicFriction>(&effect)) law = *found;
  const double angle = law.direction_deg * std::numbers::pi / 180;
  const Vec3 along(std::cos(angle), std::sin(angle), 0), across(-along.y(), along.x(), 0);
  Vec3 x = scene.bodies[0].position, v = scene.bodies[0].velocity;
  v.z() = 0;
  BodyTrack& track = history.bodies["ball"];
  constexpr int substeps = 20;
  for (std::size_t i = 0; i < history.time.size(); ++i) {
    track.position[i] = x;
    const double h = (i + 1 < history.time.size() ? history.time[i + 1] - history.time[i] : 0) / substeps;
    for (int k = 0; k < substeps; ++k) {
      const double u = v.dot(along), w = v.dot(across), size = std::hypot(u, law.ratio * w);
      if (size > 1e-9) v -= h * 9.81 * mu / size * (u * along + law.ratio * law.ratio * w * across);
      x += h * v;
    }
  }
  return history;
}

struct Slides {
  Bundle bundle;
  Problem problem;
  explicit Slides(std::vector<std::string> calibrate) : bundle(with(std::move(calibrate))), problem(bundle, {0, 1, 2, 3}, slide) {}
  static Bundle with(std::vector<std::string> calibrate) {
    Bundle bundle = flights({});
    bundle.calibrate = std::move(calibrate);
    return bundle;
  }
  Fit fit(double friction, double ratio, double direction_deg) const {
    Fit start = start_of(problem, problem.layout({{{find_effect("anisotropic_friction"), ""}}}), {0, 1, 2, 3});
    for (std::size_t i = 0; i < start.layout.shared.size(); ++i) {
      const std::string& key = start.layout.shared[i].key;
      start.shared[static_cast<Eigen::Index>(i)] = key.ends_with("friction") ? friction : key.ends_with("ratio") ? ratio : direction_deg;
    }
    return evaluated(problem, start);
  }
};

double value_of(const Fit& fit, const std::string& end) {
  for (std::size_t i = 0; i < fit.layout.shared.size(); ++i)
    if (fit.layout.shared[i].key.ends_with(end)) return fit.shared[static_cast<Eigen::Index>(i)];
  return -1;
}

TEST(QuarterTurn, IsTheSameLawWhereFrictionIsCalibrated) {
  const Slides slides({"pairs.foam-stone.friction"});
  const Fit fit = slides.fit(0.3, 1.8, 25);
  const std::optional<Fit> turned = turned_by_a_quarter(slides.problem, fit);
  ASSERT_TRUE(turned.has_value());
  EXPECT_NEAR(value_of(*turned, ".friction"), 0.54, 1e-12);
  EXPECT_NEAR(value_of(*turned, ".ratio"), 1 / 1.8, 1e-12);
  EXPECT_NEAR(value_of(*turned, "direction_deg"), -65, 1e-12);
  EXPECT_NEAR(turned->chi2, fit.chi2, 1e-6 * fit.chi2);
  EXPECT_GT(std::abs(slides.fit(0.3, 1 / 1.8, -65).chi2 - fit.chi2), 1) << "the ratio alone changes the path";
}

TEST(QuarterTurn, IsAnotherLawWhereFrictionIsStated) {
  const Slides slides({});
  EXPECT_FALSE(turned_by_a_quarter(slides.problem, slides.fit(0.5, 1.8, 25)).has_value());
}

TEST(QuarterTurn, TheFormNearerToTheScenesFrictionIsTold) {
  const Slides slides({"pairs.foam-stone.friction"});  // the scene says 0.5
  const Fit near = nearer_to_the_scene(slides.problem, slides.fit(0.3, 1.8, 25));
  EXPECT_NEAR(value_of(near, ".friction"), 0.54, 1e-12);
  EXPECT_NEAR(value_of(nearer_to_the_scene(slides.problem, near), ".friction"), 0.54, 1e-12);
}

}  // namespace
}  // namespace repose::diagnosis
