#include "tests/bench/concealment/concealable.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace repose::concealment {
namespace {

constexpr double air_density = 1.2;  // [kg/m^3]

std::string text(double value) { return fmt::format("{}", value); }
std::string text(const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

/// An effect in a fluid as dense as air, whose density is known.
Concealable in_air(const std::string& effect, const std::string& name, double lower, double upper, const std::string& phase = "") {
  return {effect, lower, upper, false, phase, [=](double strength) {
            const std::string block = "effects." + effect;
            return Change{{{block, fmt::format("{{{}: {}, fluid_density: {}}}", name, strength, air_density)}}, {}, block + "." + name, strength, 0};
          }};
}

Concealable of_the_recorder(const std::string& effect, const std::string& parameter, double lower, double upper, double null,
                            const std::function<void(Recorder&, double)>& set) {
  return {effect, lower, upper, true, "", [=](double strength) {
            Change change;
            change.parameter = effect + "." + parameter;
            change.null = null;
            change.value = null + strength;
            set(change.recorder, change.value);
            return change;
          }};
}

/// Strength in degrees about a horizontal axis; the larger of the two components is what is scored.
struct Tilt {
  double x = 0, y = 0;
  std::string larger() const { return std::abs(x) > std::abs(y) ? "x_deg" : "y_deg"; }
  double largest() const { return std::abs(x) > std::abs(y) ? x : y; }
};
Tilt tilt(double azimuth, double strength) { return {strength * std::cos(azimuth), strength * std::sin(azimuth)}; }

double angle(Random& random) { return random.uniform(-std::numbers::pi, std::numbers::pi); }

}  // namespace

Concealable number(const std::string& effect, const std::string& key, double null, double lower, double upper, bool either_sign,
                   const std::string& phase) {
  return {effect, lower, upper, either_sign, phase,
          [=](double strength) { return Change{{{key, text(null + strength)}}, {}, key, null + strength, null}; }};
}

Concealable pair_law(const std::string& effect, const std::string& pair, double lower, double upper, const std::string& phase) {
  return number(effect, "pairs." + pair + "." + effect, 0, lower, upper, false, phase);
}

Concealable factor(const std::string& effect, const std::string& key, double lower, double upper, const std::string& phase) {
  return {effect, lower, upper, true, phase,
          [=](double strength) { return Change{{{key, text(std::exp(strength))}}, {}, key, std::exp(strength), 1}; }};
}

Concealable quadratic_drag(double lower, double upper, const std::string& phase) {
  return in_air("quadratic_drag", "coefficient", lower, upper, phase);
}

Concealable linear_drag(double lower, double upper) { return number("linear_drag", "effects.linear_drag.viscosity", 0, lower, upper); }

Concealable magnus(double lower, double upper) { return in_air("magnus", "lift", lower, upper); }

Concealable uniform_force(Random& random, const std::string& axes, double lower, double upper) {
  const double a = angle(random);
  Vec3 direction(std::cos(a), std::sin(a), axes == "xyz" ? random.uniform(-1, 1) : 0);
  direction.normalize();
  return {"uniform_force", lower, upper, true, "", [=](double strength) {
            Eigen::Index largest = 0;
            direction.cwiseAbs().maxCoeff(&largest);
            return Change{{{"effects.uniform_force.force", text(strength * direction)}}, {},
                          fmt::format("effects.uniform_force.force.{}", largest), strength * direction[largest], 0};
          }};
}

Concealable gravity_tilt(Random& random, double lower, double upper) {
  return {"gravity_tilt", lower, upper, true, "", [azimuth = angle(random)](double strength) {
            const Tilt t = tilt(azimuth, strength);
            return Change{{{"effects.gravity_tilt", fmt::format("{{x_deg: {}, y_deg: {}}}", t.x, t.y)}}, {},
                          "effects.gravity_tilt." + t.larger(), t.largest(), 0};
          }};
}

Concealable periodic_force(Random& random, double lower, double upper) {
  const double frequency = random.uniform(4, 10), phase = angle(random);
  return {"periodic_force", lower, upper, false, "", [=](double strength) {
            return Change{{{"effects.periodic_force", fmt::format("{{amplitude: [{}, 0, 0], frequency: {}, phase: {}}}", strength, frequency, phase)}},
                          {}, "effects.periodic_force.frequency", frequency, 0};
          }};
}

Concealable base_vibration(Random& random, double lower, double upper) {
  const double frequency = random.uniform(5, 12), phase = angle(random);
  return {"base_vibration", lower, upper, false, "", [=](double strength) {
            return Change{{{"effects.base_vibration", fmt::format("{{amplitude: {}, frequency: {}, phase: {}}}", strength, frequency, phase)}}, {},
                          "effects.base_vibration.amplitude", strength, 0};
          }};
}

Concealable anisotropic_friction(Random& random, double lower, double upper) {
  const double direction = random.uniform(-90, 90);
  return {"anisotropic_friction", lower, upper, true, "sliding", [=](double strength) {
            const double ratio = std::exp(strength);
            return Change{{{"effects.anisotropic_friction", fmt::format("{{ratio: {}, direction_deg: {}}}", ratio, direction)}}, {},
                          "effects.anisotropic_friction.ratio", ratio, 1};
          }};
}

Concealable length_scale() {
  return of_the_recorder("length_scale", "factor", 0.002, 0.06, 1, [](Recorder& r, double v) { r.length = v; });
}
Concealable time_scale() {
  return of_the_recorder("time_scale", "factor", 0.002, 0.06, 1, [](Recorder& r, double v) { r.time = v; });
}
Concealable time_offset() {
  return of_the_recorder("time_offset", "offset", 0.002, 0.05, 0, [](Recorder& r, double v) { r.offset = v; });
}
Concealable frame_tilt(Random& random) {
  return {"frame_tilt", 0.2, 5, true, "", [azimuth = angle(random)](double strength) {
            const Tilt t = tilt(azimuth, strength);
            Change change;
            change.recorder.tilt_x = t.x;
            change.recorder.tilt_y = t.y;
            change.parameter = "frame_tilt." + t.larger();
            change.value = t.largest();
            return change;
          }};
}
Concealable sensor_bias(double lower, double upper) {
  return of_the_recorder("sensor_bias", "bias", lower, upper, 0, [](Recorder& r, double v) { r.bias = v; });
}
Concealable shifted_origin(Random& random, double lower, double upper) {
  return {"sensor_bias", lower, upper, false, "", [azimuth = angle(random)](double strength) {
            Change change;
            change.recorder.origin = strength * Vec3(std::cos(azimuth), std::sin(azimuth), 0);
            const bool along_x = std::abs(std::cos(azimuth)) > std::abs(std::sin(azimuth));
            change.parameter = along_x ? "sensor_bias.bias.0" : "sensor_bias.bias.1";
            change.value = change.recorder.origin[along_x ? 0 : 1];
            return change;
          }};
}

}  // namespace repose::concealment
