#include "tests/bench/concealment/experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "tests/bench/concealment/concealable.hpp"

namespace repose::concealment {
namespace {

constexpr int runs_of_an_experiment = 7;
const std::string velocity = "bodies.ball.velocity", spin = "bodies.ball.angular_velocity";

std::string text(const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

/// A ball of foam, wood or rubber, and a floor of stone.
struct Ball {
  double radius, density;
  double mass() const { return density * 4 / 3 * std::numbers::pi * std::pow(radius, 3); }
};
Ball draw_ball(Random& random, double lightest, double heaviest) {
  return {random.uniform(0.015, 0.035), log_uniform(random, lightest, heaviest)};
}

/// Scene text: a ball at `position`, over a floor unless it flies, and further bodies. `other`: the material that the ball meets.
std::string scene_of(const Ball& ball, const Vec3& position, double duration, const std::string& other, const std::string& more = "",
                     const std::string& top = "") {
  const bool floor = other == "stone";
  const std::string first = std::min<std::string>("ball", other), second = std::max<std::string>("ball", other);
  return fmt::format(
      "materials: {{ball: {{density: {}}}, stone: {{density: 2500}}, bead: {{density: 2600}}}}\n{}"
      "shapes: {{ball: {{type: sphere, radius: {}}}, floor: {{type: half_space}}}}\n"
      "bodies:\n{}  ball: {{shape: ball, material: ball, position: {}, velocity: [0, 0, 0], angular_velocity: [0, 0, 0]}}\n{}"
      "{}solver: {{time_step: 1.0e-3, tolerance: 1.0e-6}}\nduration: {}\n",
      ball.density, other.empty() ? "" : fmt::format("pairs: {{{}-{}: {{cohesion: 0}}}}\n", first, second), ball.radius,
      floor ? "  floor: {shape: floor, material: stone, fixed: true}\n" : "", text(position), more, top, duration);
}

Observation path_of(const std::string& body) {
  Observation o;
  o.name = "position";
  o.body = body;
  return o;
}

/// Camera and tracker: what all experiments but the accelerometer's have.
Experiment watched(const std::string& family, Random& random) {
  Experiment e;
  e.family = family;
  e.body = "ball";
  e.observables = {path_of("ball")};
  e.rate = random.uniform(60, 180);
  e.noise = {{"position", log_uniform(random, 1e-4, 8e-4)}, {"orientation", log_uniform(random, 1e-3, 8e-3)}};
  return e;
}

/// `start` draws what differs between runs.
void plan_runs(Experiment& e, const std::function<std::vector<Override>()>& start) {
  for (int i = 1; i <= runs_of_an_experiment; ++i) e.runs.push_back({fmt::format("run-{}", i), start()});
}

Experiment thrown(Random& random) {
  Experiment e = watched("throw", random);
  const Ball ball = draw_ball(random, 30, 300);
  const bool two = random.uniform() < 0.5;
  const std::string bead =
      "  bead: {shape: ball, material: bead, position: [0, 0.5, 1], velocity: [1.5, 0, 2], angular_velocity: [0, 0, 0]}\n";
  e.scene = scene_of(ball, {0, 0, 1}, random.uniform(0.4, 0.7), two ? "bead" : "", two ? bead : "");
  if (two) e.observables.push_back(path_of("bead"));
  plan_runs(e, [&] {
    return std::vector<Override>{{velocity, text({random.uniform(1, 5), random.uniform(-1, 1), random.uniform(0, 3)})},
                                 {spin, text({random.uniform(-30, 30), random.uniform(-30, 30), random.uniform(-30, 30)})}};
  });
  e.free = {velocity};
  const double weight = ball.mass() * 9.81, light = ball.density / 50;
  e.effects = {quadratic_drag(0.01 * light, light),
               linear_drag(1e-4 * light, 6e-3 * light),
               magnus(0.005 * light, 0.4 * light),
               uniform_force(random, "xyz", 0.003 * weight, 0.3 * weight),
               gravity_tilt(random, 0.1, 8),
               number("buoyancy", "effects.buoyancy.fluid_density", 0, 0.003 * ball.density, 0.2 * ball.density),
               periodic_force(random, 0.1, 4),
               length_scale(),
               time_scale(),
               time_offset(),
               frame_tilt(random),
               shifted_origin(random, 3e-4, 0.03)};
  e.opposed = {{"quadratic_drag", "length_scale"}, {"quadratic_drag", "uniform_force"}, {"linear_drag", "time_scale"}, {"magnus", "gravity_tilt"}};
  return e;
}

Experiment rolled(Random& random) {
  Experiment e = watched("roll", random);
  const Ball ball = draw_ball(random, 100, 2000);
  e.scene = scene_of(ball, {0, 0, ball.radius}, random.uniform(0.6, 0.9), "stone");
  e.constants = {{"pairs.ball-stone.friction", fmt::format("{}", random.uniform(0.2, 0.5))}};
  e.knob = "pairs.ball-stone.friction";
  e.knob_lower = 0.05;
  e.knob_upper = 1;
  plan_runs(e, [&] {
    return std::vector<Override>{{velocity, text({random.uniform(0.6, 1.6), random.uniform(-0.3, 0.3), 0})},
                                 {spin, text({0, 0, random.uniform(-30, 30)})}};
  });
  e.free = {velocity};
  const double weight = ball.mass() * 9.81, light = ball.density / 50;
  e.effects = {pair_law("rolling_friction", "ball-stone", 0.002, 0.1, "rolling"),
               pair_law("spinning_friction", "ball-stone", 0.002, 0.08),
               pair_law("friction", "ball-stone", 0.05, 0.4, "sliding"),
               quadratic_drag(0.05 * light, 2 * light),
               uniform_force(random, "xy", 0.002 * weight, 0.06 * weight),
               gravity_tilt(random, 0.1, 4),
               factor("inertia", "effects.inertia.factor", 0.02, 0.5, "sliding"),
               length_scale(),
               time_scale(),
               frame_tilt(random),
               shifted_origin(random, 3e-4, 0.03)};
  e.opposed = {{"rolling_friction", "gravity_tilt"}, {"rolling_friction", "length_scale"}, {"quadratic_drag", "uniform_force"}};
  return e;
}

Experiment slid(Random& random) {
  Experiment e = watched("slide", random);
  const Ball ball = draw_ball(random, 300, 2000);
  e.scene = scene_of(ball, {0, 0, 0.02}, 0.5, "stone");
  const std::string from = "{type: sphere, radius: " + fmt::format("{}", ball.radius) + "}";
  e.scene.replace(e.scene.find(from), from.size(), "{type: box, size: [0.1, 0.1, 0.04]}");
  e.constants = {{"pairs.ball-stone.friction", fmt::format("{}", random.uniform(0.15, 0.35))}};
  e.knob = "pairs.ball-stone.friction";
  e.knob_lower = 0.03;
  e.knob_upper = 1;
  e.knob_unmeasured = true;
  plan_runs(e, [&] {
    const double a = random.uniform(-std::numbers::pi, std::numbers::pi), v = random.uniform(1, 2.5);
    return std::vector<Override>{{velocity, text({v * std::cos(a), v * std::sin(a), 0})}};
  });
  e.free = {velocity};
  const double weight = ball.density * 4e-4 * 9.81;
  Concealable rate = number("rate_dependent_friction", "effects.rate_dependent_friction.slope", 0, 0.003, 0.1, true, "sliding");
  rate.at = [at = rate.at](double strength) {
    Change change = at(strength);
    change.scene.push_back({"effects.rate_dependent_friction.reference_speed", "1"});
    return change;
  };
  e.effects = {rate,
               anisotropic_friction(random, 0.02, 0.7),
               pair_law("friction", "ball-stone", 0.05, 0.4, "sliding"),
               gravity_tilt(random, 0.2, 6),
               uniform_force(random, "xy", 0.005 * weight, 0.1 * weight),
               length_scale(),
               time_scale()};
  e.opposed = {{"rate_dependent_friction", "length_scale"}, {"anisotropic_friction", "gravity_tilt"}};
  return e;
}

Experiment bounced(Random& random) {
  Experiment e = watched("bounce", random);
  const Ball ball = draw_ball(random, 60, 1500);
  e.scene = scene_of(ball, {0, 0, 0.3}, random.uniform(0.6, 0.9), "stone");
  e.constants = {{"pairs.ball-stone.friction", fmt::format("{}", random.uniform(0.2, 0.5))},
                 {"pairs.ball-stone.restitution", fmt::format("{}", random.uniform(0.5, 0.9))}};
  e.knob = "pairs.ball-stone.restitution";
  e.knob_lower = 0.1;
  e.knob_upper = 1;
  plan_runs(e, [&] {
    return std::vector<Override>{{velocity, text({random.uniform(0, 1), random.uniform(-0.3, 0.3), random.uniform(-2.5, 0)})},
                                 {spin, text({random.uniform(-20, 20), random.uniform(-20, 20), 0})}};
  });
  e.free = {velocity};
  const double light = ball.density / 50;
  Concealable rate = number("rate_dependent_restitution", "effects.rate_dependent_restitution.exponent", 0, 0.01, 0.3, false, "impact");
  rate.at = [at = rate.at](double strength) {
    Change change = at(strength);
    change.scene.push_back({"effects.rate_dependent_restitution.reference_speed", "1"});
    return change;
  };
  e.effects = {pair_law("restitution", "ball-stone", 0.2, 0.8, "impact"),
               rate,
               pair_law("friction", "ball-stone", 0.05, 0.4, "impact"),
               quadratic_drag(0.02 * light, light, "flight"),
               gravity_tilt(random, 0.2, 6),
               factor("inertia", "effects.inertia.factor", 0.03, 0.5, "impact"),
               length_scale(),
               time_scale(),
               shifted_origin(random, 3e-4, 0.03)};
  e.opposed = {{"rate_dependent_restitution", "length_scale"}, {"quadratic_drag", "time_scale"}};
  return e;
}

Experiment spun(Random& random) {
  Experiment e = watched("spin", random);
  const Ball ball = draw_ball(random, 100, 2000);
  e.scene = scene_of(ball, {0, 0, ball.radius}, random.uniform(0.6, 0.9), "stone");
  e.constants = {{"pairs.ball-stone.friction", "0.3"}, {"pairs.ball-stone.spinning_friction", fmt::format("{}", random.uniform(0.01, 0.05))}};
  e.knob = "pairs.ball-stone.spinning_friction";
  e.knob_lower = 0.001;
  e.knob_upper = 0.3;
  plan_runs(e, [&] { return std::vector<Override>{{spin, text({0, 0, random.uniform(15, 50)})}}; });
  e.free = {spin};
  e.effects = {pair_law("spinning_friction", "ball-stone", 0.002, 0.08),
               linear_drag(3e-5 * ball.density, 3e-3 * ball.density),
               gravity_tilt(random, 0.1, 3),
               factor("inertia", "effects.inertia.factor", 0.03, 0.5),
               time_scale()};
  e.opposed = {{"linear_drag", "time_scale"}, {"spinning_friction", "time_scale"}};
  return e;
}

Experiment collided(Random& random) {
  Experiment e = watched("impact", random);
  const Ball ball = draw_ball(random, 60, 1500);
  const double r = ball.radius;
  e.scene = scene_of(ball, {-0.2, 0, 1}, random.uniform(0.4, 0.6), "ball",
                     "  target: {shape: ball, material: ball, position: [0, 0, 1], velocity: [0, 0, 0], angular_velocity: [0, 0, 0]}\n",
                     "gravity: [0, 0, 0]\n");
  e.observables.push_back(path_of("target"));
  e.constants = {{"pairs.ball-ball.friction", fmt::format("{}", random.uniform(0.1, 0.4))},
                 {"pairs.ball-ball.restitution", fmt::format("{}", random.uniform(0.5, 0.9))}};
  e.knob = "pairs.ball-ball.restitution";
  e.knob_lower = 0.1;
  e.knob_upper = 1;
  plan_runs(e, [&] {
    return std::vector<Override>{{velocity, text({random.uniform(1, 2.5), 0, 0})},
                                 {"bodies.target.position", text({0, random.uniform(-1.2, 1.2) * r, 1 + random.uniform(-1.2, 1.2) * r})}};
  });
  e.free = {velocity};
  const double light = ball.density / 50;
  e.effects = {pair_law("restitution", "ball-ball", 0.2, 0.8, "impact"),
               pair_law("friction", "ball-ball", 0.05, 0.4, "impact"),
               factor("inertia", "effects.inertia.factor", 0.03, 0.5, "impact"),
               quadratic_drag(0.05 * light, 2 * light, "flight"),
               uniform_force(random, "xyz", 0.02 * ball.mass(), 2 * ball.mass()),
               length_scale()};
  e.opposed = {{"quadratic_drag", "length_scale"}, {"quadratic_drag", "uniform_force"}};
  return e;
}

/// Falls, lands without a rebound, slides, rolls: each effect acts in one part.
Experiment lobbed(Random& random) {
  Experiment e = watched("lob", random);
  const Ball ball = draw_ball(random, 80, 1000);
  e.scene = scene_of(ball, {0, 0, random.uniform(0.15, 0.3)}, random.uniform(0.8, 1), "stone");
  e.constants = {{"pairs.ball-stone.friction", fmt::format("{}", random.uniform(0.2, 0.5))},
                 {"pairs.ball-stone.rolling_friction", fmt::format("{}", random.uniform(0.01, 0.05))}};
  e.knob = "pairs.ball-stone.rolling_friction";
  e.knob_lower = 0;
  e.knob_upper = 0.3;
  plan_runs(e, [&] { return std::vector<Override>{{velocity, text({random.uniform(0.8, 2), random.uniform(-0.3, 0.3), random.uniform(0, 0.8)})}}; });
  e.free = {velocity};
  const double light = ball.density / 50;
  e.effects = {pair_law("rolling_friction", "ball-stone", 0.004, 0.1, "rolling"),
               pair_law("friction", "ball-stone", 0.05, 0.4, "sliding"),
               pair_law("restitution", "ball-stone", 0.05, 0.6, "impact"),
               quadratic_drag(0.05 * light, 2 * light)};
  e.opposed = {{"rolling_friction", "quadratic_drag"}};
  return e;
}

/// A box that falls with an accelerometer on board.
Experiment felt(Random& random) {
  Experiment e;
  e.family = "accelerometer";
  e.body = "ball";
  const Ball box{0.03, log_uniform(random, 60, 600)};
  e.scene = scene_of(box, {0, 0, 5}, random.uniform(0.5, 0.9), "");
  for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(1, 0, 0)}) {
    Observation o;
    o.kind = ObservableKind::series;
    o.name = "specific_force";
    o.body = "ball";
    o.axis = axis;
    o.unit = "m/s^2";
    if (axis.z() > 0 || random.uniform() < 0.5) e.observables.push_back(o);
  }
  e.rate = random.uniform(60, 200);
  e.noise = {{"specific_force", log_uniform(random, 0.01, 0.05)}};
  plan_runs(e, [&] { return std::vector<Override>{{velocity, text({random.uniform(0, 5), 0, random.uniform(-6, 1)})}}; });
  const double light = box.density / 50;
  e.effects = {quadratic_drag(0.005 * light, light), linear_drag(5e-5 * light, 6e-3 * light), sensor_bias(0.005, 0.5), periodic_force(random, 0.02, 3)};
  e.opposed = {{"quadratic_drag", "sensor_bias"}};
  return e;
}

/// A ball rolls on a table that may shake.
Experiment shaken(Random& random) {
  Experiment e = watched("shaken", random);
  const Ball ball = draw_ball(random, 500, 3000);
  e.scene = scene_of(ball, {0, 0, ball.radius}, 0.8, "stone");
  e.constants = {{"pairs.ball-stone.friction", fmt::format("{}", random.uniform(0.3, 0.6))}};
  plan_runs(e, [&] { return std::vector<Override>{{velocity, text({random.uniform(0.2, 0.8), random.uniform(-0.2, 0.2), 0})}}; });
  e.free = {velocity};
  e.effects = {base_vibration(random, 1e-4, 1.5e-3), periodic_force(random, 0.05, 2), pair_law("rolling_friction", "ball-stone", 0.003, 0.08, "rolling")};
  e.opposed = {{"rolling_friction", "periodic_force"}};
  return e;
}

/// A ball is laid on a plate that moves.
Experiment conveyed(Random& random) {
  Experiment e = watched("conveyor", random);
  const Ball ball = draw_ball(random, 300, 2000);
  e.scene = scene_of(ball, {0, 0, ball.radius}, 0.8, "stone");
  const std::string from = "fixed: true", to = fmt::format("motion: {{velocity: [{}, 0, 0]}}", random.uniform(0.3, 1));
  e.scene.replace(e.scene.find(from), from.size(), to);
  e.constants = {{"pairs.ball-stone.friction", fmt::format("{}", random.uniform(0.1, 0.3))}};
  e.knob = "pairs.ball-stone.friction";
  e.knob_lower = 0.03;
  e.knob_upper = 1;
  plan_runs(e, [&] { return std::vector<Override>{{velocity, text({random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 0})}}; });
  e.free = {velocity};
  e.effects = {factor("moving_wall_speed", "effects.moving_wall_speed.factor", 0.01, 0.3),
               pair_law("friction", "ball-stone", 0.05, 0.4, "sliding"),
               pair_law("rolling_friction", "ball-stone", 0.003, 0.1, "rolling"),
               factor("inertia", "effects.inertia.factor", 0.03, 0.5, "sliding"),
               gravity_tilt(random, 0.1, 4)};
  e.opposed = {{"moving_wall_speed", "gravity_tilt"}};
  return e;
}

}  // namespace

double log_uniform(Random& random, double lower, double upper) { return lower * std::pow(upper / lower, random.uniform()); }

const std::vector<std::string>& families() {
  static const std::vector<std::string> names{"throw", "roll", "slide", "bounce", "spin", "impact", "lob", "accelerometer", "shaken", "conveyor"};
  return names;
}

Experiment draw_experiment(const std::string& family, Random& random) {
  using Draw = Experiment (*)(Random&);
  constexpr Draw draws[] = {thrown, rolled, slid, bounced, spun, collided, lobbed, felt, shaken, conveyed};
  for (std::size_t i = 0; i < families().size(); ++i)
    if (families()[i] == family) return draws[i](random);
  throw Error(family, "no such family of experiments", fmt::format("known: {}", fmt::join(families(), ", ")));
}

}  // namespace repose::concealment
