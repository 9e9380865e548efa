#include "core/plausibility.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/overlap.hpp"
#include "core/scene_yaml.hpp"

namespace repose {
namespace {

using Level = Finding::Level;

const std::string heap = R"(materials: {pa12: {density: 1020}, steel: {density: 7800}}
pairs:
  pa12-pa12: {friction: 0.5, restitution: 0.2}
  pa12-steel: {friction: 0.5}
grains:
  powder:
    material: pa12
    count: 50
    size: {normal: [58 um, 15 um], range: [30 um, 100 um]}
    fill: {frustum: {base: [0, 0, 1 mm], radius_bottom: 0.3 mm, radius_top: 0.6 mm, height: 0.5196 mm}}
tools:
  funnel: {material: steel, position: [0, 0, 1 mm], outlet_diameter: 0.6 mm, top_diameter: 1.2 mm, wall_height: 1 mm, thickness: 0.1 mm, opens: 0.02}
  base: {material: steel, diameter: 2 mm, rim_height: 0.1 mm, rim_width: 0.1 mm, trench_width: 0.5 mm, trench_depth: 0.2 mm, trench_wall: 0.3 mm}
solver: {time_step: 5.0e-5}
duration: 0.1
)";

std::vector<Finding> check(const std::string& text, const std::vector<Override>& overrides) {
  const Scene scene = parse_scene(text, "heap.yaml", overrides);
  const std::vector<Finding> before = check_before_realising(scene);
  const bool refused =
      std::any_of(before.begin(), before.end(), [](const Finding& f) { return f.level == Level::refusal; });
  if (refused) return before;
  const Model model = realise(scene, 1);
  return check_plausibility(scene, &model);
}

/// The worst level among the findings whose place begins with `place`.
Level worst(const std::vector<Finding>& findings, const std::string& place) {
  Level level = Level::note;
  for (const Finding& f : findings)
    if (f.place.starts_with(place)) level = std::max(level, f.level);
  return level;
}

std::string text_of(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& f : findings) text += f.place + ": " + f.message + "; " + f.remedy + "\n";
  return text;
}

TEST(Plausibility, ASoundSceneHasNotesOnly) {
  const std::vector<Finding> findings = check(heap, {});
  EXPECT_EQ(worst(findings, ""), Level::note) << text_of(findings);
  EXPECT_FALSE(findings.empty());
}

TEST(Plausibility, WarnsOfASpreaderThatPassesOverAPartOfTheRegionOnly) {
  const std::string text = R"(
materials: {pa12: {density: 1020}, steel: {density: 7800}}
pairs: {pa12-pa12: {friction: 0.5}, pa12-steel: {friction: 0.5}}
grains: {bed: {material: pa12, count: 5, size: 58 um, fill: {box: {lower: [0, 0, 0], upper: [2 mm, 1 mm, 0.2 mm]}}}}
tools: {blade: {type: blade, material: steel, position: [0, 0.5 mm, 0], thickness: 1 mm, height: 2 mm, width: 1 mm}}
layer:
  {spreader: blade, gap: 0.1 mm, speed: 0.1, from: FROM, to: TO, settle: 0.1, settle_time_step: 2.0e-5,
   region: {lower: [0.5 mm, 0], upper: [1.5 mm, 1 mm]}, surface: {cell: 10 um, square: 58 um}}
solver: {time_step: 2.0e-5}
duration: 0.1
)";
  const auto found = [&](const std::string& from, const std::string& to, const std::vector<Override>& overrides = {}) {
    std::string now = text;
    now.replace(now.find("FROM"), 4, from);
    now.replace(now.find("TO"), 2, to);
    return check_before_realising(parse_scene(now, "layer.yaml", overrides));
  };
  EXPECT_EQ(worst(found("0", "1.5 mm"), "layer"), Level::note);
  EXPECT_EQ(worst(found("0", "1.5 mm"), "tools.blade.width"), Level::note);
  EXPECT_EQ(worst(found("0", "1.5 mm", {{"tools.blade.width", "0.9 mm"}}), "tools.blade.width"), Level::warning);
  EXPECT_EQ(worst(found("0", "1.5 mm", {{"tools.blade.position", "[0, 0.6 mm, 0]"}}), "tools.blade.width"), Level::warning);
  EXPECT_EQ(worst(found("0", "1.5 mm", {{"tools.blade.position", "[0, 0.6 mm, 0]"}, {"tools.blade.width", "1.2 mm"}}), "tools.blade.width"), Level::note);
  EXPECT_EQ(worst(found("0", "1.4 mm"), "layer.to"), Level::warning);
  EXPECT_EQ(worst(found("0", "1.4 mm"), "layer.from"), Level::note);
  EXPECT_EQ(worst(found("0.6 mm", "1.6 mm"), "layer.from"), Level::warning);
}

TEST(Plausibility, WarnsOfAGapAboveThePlateThatTheLargestGrainDoesNotFitInto) {
  const std::string text = R"(
materials: {pa12: {density: 1020}, steel: {density: 7800}}
pairs: {pa12-pa12: {friction: 0.5}, pa12-steel: {friction: 0.5}}
grains:
  pile: {material: pa12, count: 5, size: {normal: [58 um, 15 um], range: [30 um, 100 um]}, fill: {box: {lower: [-1 mm, -0.5 mm, 0], upper: [0, 0.5 mm, 1 mm]}}}
tools: {roller: {type: roller, material: steel, diameter: 70 mm, width: 1 mm}}
layer:
  {spreader: roller, gap: 60 um, speed: 0.1, to: 2 mm, settle: 0.1, settle_time_step: 2.0e-5,
   region: {lower: [0.5 mm, -0.5 mm], upper: [1.5 mm, 0.5 mm]}, surface: {cell: 10 um, square: 58 um}}
solver: {time_step: 2.0e-5}
duration: 0.1
)";
  const auto level = [&](std::vector<Override> overrides) {
    return worst(check_before_realising(parse_scene(text, "layer.yaml", overrides)), "layer.gap");
  };
  const Override over_a_bed{"grains.pile.fill.box.upper", "[1 mm, 0.5 mm, 1 mm]"}, from_plate{"layer.gap_from", "plate"};
  EXPECT_EQ(level({}), Level::warning);  // no bed: the gap is one above the plate
  EXPECT_EQ(level({{"layer.gap", "101 um"}}), Level::note);
  EXPECT_EQ(level({over_a_bed}), Level::note);
  EXPECT_EQ(level({over_a_bed, from_plate}), Level::warning);
  EXPECT_EQ(level({over_a_bed, from_plate, {"layer.gap", "101 um"}}), Level::note);
  EXPECT_EQ(level({from_plate, {"tools.roller.yield", "{load: 1 uN, mass: 1 ug}"}}), Level::note);
}

TEST(Plausibility, JudgesEveryGroup) {
  const struct {
    Override change;
    std::string place;
    Level level;
    std::string part;
  } cases[] = {
      {{"materials.pa12.density", "2.5"}, "materials.pa12.density", Level::refusal, "did you mean 2.5 g/cm3?"},
      {{"materials.pa12.density", "1020000"}, "materials.pa12.density", Level::refusal, "did you mean 1020 kg/m3?"},
      {{"materials.pa12.density", "30"}, "materials.pa12.density", Level::warning, "30 kg/m3"},
      {{"grains.powder.size", "45"}, "grains.powder.size", Level::refusal, "did you mean 45 um?"},
      {{"grains.powder.size", "58e-10"}, "grains.powder.size", Level::refusal, "5.8 nm"},
      {{"grains.powder.size.range", "[5 um, 100 um]"}, "grains.powder.size", Level::warning, "ratio"},
      {{"grains.powder.count", "1e9"}, "grains", Level::refusal, "1e+09 grains"},
      {{"grains.powder.velocity", "[0, 0, -5000]"}, "grains.powder.velocity", Level::refusal, "5000 mm/s"},
      {{"solver.time_step", "10"}, "solver.time_step", Level::refusal, "longer than the duration"},
      {{"solver.time_step", "0.05"}, "solver.time_step", Level::refusal, "sqrt(R/g)"},
      {{"solver.time_step", "1e-3"}, "solver.time_step", Level::warning, "sqrt(R/g)"},
      {{"solver.time_step", "1e-13"}, "solver.time_step", Level::refusal, "steps"},
      {{"gravity", "[0, 0, 9.81]"}, "gravity", Level::warning, "z is up"},
      {{"gravity", "[0, 0, -9810]"}, "gravity", Level::refusal, "-9.81"},
      {{"pairs.pa12-pa12.cohesion", "1"}, "pairs.pa12-pa12.cohesion", Level::refusal, "did you mean 1 nN?"},
      {{"pairs.pa12-pa12.cohesion", "10 nN"}, "pairs.pa12-pa12.cohesion_range", Level::warning, "slightest gap"},
      {{"pairs.pa12-pa12.friction", "52"}, "pairs.pa12-pa12.friction", Level::refusal, "0.52"},
      {{"pairs.pa12-pa12.rolling_friction_length", "0.05"}, "pairs.pa12-pa12.rolling", Level::refusal, "_length"},
      {{"tools.funnel.outlet_diameter", "80 um"}, "tools.funnel.outlet_diameter", Level::refusal, "do not pass"},
      {{"tools.funnel.outlet_diameter", "0.2 mm"}, "tools.funnel.outlet_diameter", Level::warning, "arches"},
      {{"tools.funnel.opens", "0.2"}, "tools.funnel.opens", Level::refusal, "the run ends"},
      {{"tools.funnel.opens", "0.09"}, "tools.funnel.opens", Level::warning, "last fifth"},
      {{"tools.funnel.position", "[0, 0, -1 mm]"}, "tools.funnel.position", Level::refusal, "below the plate"},
      {{"tools.funnel.position", "[0, 0, 0.05 mm]"}, "tools.base", Level::refusal, "cut into each other"},
      {{"tools.base.diameter", "50 um"}, "tools.base.diameter", Level::refusal, "base of 50 um"},
      {{"tools.base.diameter", "500 um"}, "tools.base.diameter", Level::warning, "no heap"},
      {{"grains.powder.fill.frustum.radius_bottom", "0.5 mm"},
       "grains.powder.fill",
       Level::refusal,
       "radius of 300 um"},
      {{"grains.powder.fill.frustum.base", "[0, 0, 0.8 mm]"}, "grains.powder.fill", Level::refusal, "below the outlet"},
      {{"tools.wall", "{type: plate, material: steel, size: [1 mm, 1 mm, 1 mm]}"},
       "tools.base",
       Level::refusal,
       "`wall`"},
      {{"frame_interval", "1"}, "frame_interval", Level::warning, "longer"},
  };
  for (const auto& c : cases) {
    const std::vector<Finding> findings = check(heap, {c.change});
    EXPECT_EQ(worst(findings, c.place), c.level) << c.change.path << "\n" << text_of(findings);
    EXPECT_NE(text_of(findings).find(c.part), std::string::npos) << c.change.path << "\n" << text_of(findings);
    for (const Finding& f : findings)
      EXPECT_EQ(f.remedy.empty(), f.level == Level::note) << f.place << ": " << f.message;
  }
}

TEST(Plausibility, MetreSizedBodiesAreFine) {
  const std::string text = R"(materials: {ball: {density: 70}, ground: {density: 2000}}
pairs: {ball-ground: {friction: 0.5}}
shapes: {ball: {type: sphere, radius: 0.12}, ground: {type: half_space}}
bodies:
  ball: {shape: ball, material: ball, position: [0, 0, 47], mass: 0.6}
  ground: {shape: ground, material: ground, fixed: true}
solver: {time_step: 1 ms}
duration: 4
)";
  EXPECT_EQ(worst(check(text, {}), ""), Level::note) << text_of(check(text, {}));
  EXPECT_EQ(worst(check(text, {{"bodies.ball.mass", "1e-9"}}), "bodies.ball.mass"), Level::refusal);
  EXPECT_EQ(worst(check(text, {{"bodies.ball.position", "[0, 0, 0]"}}), "bodies.ball.position"), Level::warning);
  EXPECT_EQ(worst(check(text, {{"bodies.ball.position", "[0, 0, 0.12]"}}), "bodies.ball.position"), Level::note);
}

TEST(Plausibility, DensityOfABodyWithItsOwnMassIsOnlyAWarning) {
  const std::string text =
      "materials: {a: {density: 1}}\nshapes: {s: {type: sphere, radius: 0.1}}\n"
      "bodies: {b: {shape: s, material: a, mass: 1}}\nduration: 1\n";
  EXPECT_EQ(worst(check(text, {}), "materials"), Level::warning);
}

TEST(Overlap, FindsCutsAndSparesTouching) {
  const Shape unit = make_shape("box", {Part{Box{Vec3(1, 1, 1)}, Pose{}}});
  const Shape ball = make_shape("sphere", {Part{Sphere{1}, Pose{}}});
  const Shape ground = make_shape("half_space", {Part{HalfSpace{}, Pose{}}});
  const Pose origin{};
  const auto at = [](double x, double y, double z) { return Pose{Vec3(x, y, z), Quat::Identity()}; };
  EXPECT_TRUE(cut_into(unit, origin, unit, origin, 1e-6));
  EXPECT_TRUE(cut_into(unit, origin, unit, at(1.9, 0, 0), 1e-6));
  EXPECT_FALSE(cut_into(unit, origin, unit, at(2, 0, 0), 1e-6));
  EXPECT_FALSE(cut_into(ball, at(0, 0, 1), ground, origin, 1e-6));
  EXPECT_TRUE(cut_into(ball, at(0, 0, 0.9), ground, origin, 1e-6));
  EXPECT_TRUE(cut_into(ground, origin, ball, at(0, 0, 0.9), 1e-6));
  EXPECT_FALSE(cut_into(ball, at(0, 0, 0.999), ground, origin, 0.01));
  EXPECT_FALSE(cut_into(ball, origin, unit, at(2.1, 0, 0), 1e-6));
}

TEST(Overlap, SurfacePointsLieOnTheirSurface) {
  const Cone cone{1, 2};
  for (const Vec3& point : surface_points(cone))
    EXPECT_TRUE(contains(Primitive{cone}, point * (1 - 1e-9) + Vec3(0, 0, 1e-10)));
  for (const Vec3& point : surface_points(Ellipsoid{Vec3(1, 2, 3)}))
    EXPECT_NEAR(point.cwiseQuotient(Vec3(1, 2, 3)).norm(), 1, 1e-12);
}

}  // namespace
}  // namespace repose
