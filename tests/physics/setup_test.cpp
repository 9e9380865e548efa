/// Set-ups that are not what they seem: other inertia, a centre of mass that is not in the centre, a shaking ground.
#include <algorithm>
#include <cmath>
#include <string>

#include "core/scene_yaml.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Setup : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Setup);

constexpr double g = 9.81, radius = 0.02;

/// A ball on a rough floor, from YAML: bodies are the ball (0) and the floor (1).
Model ball(const std::string& effects, const std::string& more = "orientation: [1, 0, 0, 0]") {
  const std::string text =
      "materials: {m: {density: 1000}}\npairs: {m-m: {friction: 1}}\n"
      "shapes: {ball: {type: sphere, radius: 0.02}, floor: {type: half_space, normal: [0, 0, 1]}}\n"
      "bodies:\n  ball: {shape: ball, material: m, position: [0, 0, 0.02], " +
      more +
      "}\n"
      "  floor: {shape: floor, material: m, fixed: true}\n"
      "effects: {" +
      effects + "}\nduration: 1\n";
  return realise(parse_scene(text, "setup_test"), 1);
}

TEST_P(Setup, InertiaChangesHowABallRolls) {
  for (const double factor : {1.0, 5.0 / 3}) {  // solid, and a thin shell
    const double angle = 0.2;
    const Model model = ball("gravity_tilt: {y_deg: " + std::to_string(-angle * 180 / M_PI) +
                             "}, inertia: {factor: " + std::to_string(factor) + "}");
    auto s = simulation(model, precise(1e-3));
    s.run(300);
    const double wanted = 0.3 * g * std::sin(angle) / (1 + 0.4 * factor);
    expect_answer({"rolling ball, inertia times " + std::to_string(factor).substr(0, 4) + ", speed after 0.3 s [m/s]",
                   wanted, s.velocity(0).x(), 1e-6},
                  GetParam());
  }
}

TEST_P(Setup, AnOffCentreBallIsAPendulum) {
  // It rolls about its lowest point: (I + m (R - d)^2) w'' = -m g d w.
  const double d = 0.006, tilt = 0.02;
  const double period = 2 * M_PI * std::sqrt((0.4 * radius * radius + (radius - d) * (radius - d)) / (g * d));
  const Model model = ball(
      "center_of_mass_offset: {offset: [0, 0, -0.006]}",
      "orientation: [" + std::to_string(std::cos(tilt / 2)) + ", 0, " + std::to_string(std::sin(tilt / 2)) + ", 0]");
  const double h = 2e-4;
  auto s = simulation(model, precise(h));
  double before = 1, first = 0, last = 0;
  int crossings = 0;
  s.run(static_cast<int>(5.2 * period / h), [&](const Simulation& now) {
    const double lean = (now.state().orientation[0] * Vec3::UnitZ()).x();
    if (before > 0 && lean <= 0) {
      last = now.state().time - h * lean / (lean - before);
      if (crossings++ == 0) first = last;
    }
    before = lean;
  });
  ASSERT_EQ(crossings, 5);
  expect_answer({"ball with its centre of mass 0.3 R below the middle, period [s]", period, (last - first) / 4, 1e-3},
                GetParam());
}

TEST_P(Setup, AShakingGroundLiftsWhatItAcceleratesBeyondGravity) {
  // z = A (1 - cos wt): the ball leaves when A w^2 cos wt = -g and flies freely.
  const double frequency = 20, w = 2 * M_PI * frequency, h = 1e-5;
  for (const double share : {0.95, 1.4}) {
    const double amplitude = share * g / (w * w);
    const Model model =
        ball("base_vibration: {amplitude: " + std::to_string(1e6 * amplitude) + " um, frequency: 20, phase: -90 deg}");
    auto s = simulation(model, precise(h));
    double highest = 0;
    s.run(static_cast<int>(1 / (frequency * h)), [&](const Simulation& now) {
      highest = std::max(highest, now.position(0).z() - radius - now.position(1).z());
    });
    double expected = 0;
    if (share > 1) {
      const double leaves = std::acos(-1 / share) / w;
      for (double t = leaves; t < 1 / frequency; t += h / 10) {
        const double free = amplitude * (1 - std::cos(w * leaves)) +
                            amplitude * w * std::sin(w * leaves) * (t - leaves) - 0.5 * g * (t - leaves) * (t - leaves);
        expected = std::max(expected, free - amplitude * (1 - std::cos(w * t)));
      }
    }
    expect_answer({"ground shaken by " + std::to_string(share).substr(0, 4) + " g: highest lift [um]", 1e6 * expected,
                   1e6 * highest, 0.01, 1e6 * expected, 1e6 * amplitude},
                  GetParam());
  }
}

}  // namespace
}  // namespace repose::test
