#include "core/setup_effects.hpp"

#include <cmath>

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/overloaded.hpp"
#include "core/scene.hpp"

namespace repose {
namespace {

[[noreturn]] void nothing_to_change(const std::string& effect, const std::string& problem, const std::string& remedy) {
  throw Error("effects." + effect, problem, remedy);
}

void vibrate(const BaseVibration& effect, const std::string& place, Motion& motion) {
  if (!motion.vibration_amplitude.isZero(0))
    throw Error("effects.base_vibration", place + " vibrates already", "remove one of the two vibrations");
  motion.vibration_amplitude = {0, 0, effect.amplitude};
  motion.vibration_frequency = effect.frequency;
  motion.vibration_phase = effect.phase;
}

bool carries(const ToolKind& kind) {
  return std::visit(Overloaded{[](const Base&) { return true; }, [](const Plate&) { return true; },
                               [](const Floor&) { return true; }, [](const Container&) { return true; },
                               [](const Cup&) { return true; }, [](const Funnel&) { return false; },
                               [](const Roller&) { return false; }, [](const Blade&) { return false; },
                               [](const Drum&) { return false; }},
                    kind);
}

/// x -> factor (m + spread (x - m)).
struct LinearMap {
  double mean, factor, spread;
  double operator()(double x) const { return factor * (mean + spread * (x - mean)); }
};

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double x : values) sum += x;
  return sum / static_cast<double>(values.size());
}

/// Limits that are set move with the sizes; those that are not stay where they are.
template <class Map>
void move_range(SizeDistribution& size, const Map& map) {
  if (size.lower > 0) size.lower = map(size.lower);
  if (size.upper < SizeDistribution{}.upper) size.upper = map(size.upper);
}

void change_sizes(SizeDistribution& size, const SizeDistributionFactors& f) {
  std::visit(Overloaded{[&](FixedSize& law) {
                          const LinearMap map{law.value, f.mean_factor, f.sd_factor};
                          law.value = map(law.value);
                          move_range(size, map);
                        },
                        [&](NormalSize& law) {
                          const LinearMap map{law.mean, f.mean_factor, f.sd_factor};
                          law.mean *= f.mean_factor;
                          law.sd *= f.mean_factor * f.sd_factor;
                          move_range(size, map);
                        },
                        [&](LogNormalSize& law) {
                          const double median = law.median;
                          law.median *= f.mean_factor;
                          law.log_sd *= f.sd_factor;
                          move_range(size, [&](double x) {
                            return f.mean_factor * median * std::pow(x / median, f.sd_factor);
                          });
                        },
                        [&](TableSize& law) {
                          const LinearMap map{mean_of(law.values), f.mean_factor, f.sd_factor};
                          for (double& x : law.values) x = map(x);
                          move_range(size, map);
                        }},
             size.law);
}

bool reaches_zero(const SizeDistribution& before, const SizeDistribution& after) {
  if (before.lower > 0 && !(after.lower > 0)) return true;
  if (const auto* law = std::get_if<NormalSize>(&after.law)) return after.lower == 0 && law->mean < 5 * law->sd;
  if (const auto* table = std::get_if<TableSize>(&after.law))
    for (const double x : table->values)
      if (!(x > 0)) return true;
  return false;
}

}  // namespace

bool is_wall_material(const Scene& scene, const std::string& material) {
  bool wall = false, free = false;
  for (const Tool& tool : scene.tools) wall = wall || tool.material == material;
  for (const SceneBody& body : scene.bodies)
    if (body.material == material) (body.fixed || body.motion ? wall : free) = true;
  for (const GrainPopulation& grains : scene.grains) free = free || grains.material == material;
  return wall && !free;
}

void apply(const BaseVibration& effect, Scene& scene) {
  bool any = false;
  for (Tool& tool : scene.tools) {
    if (!carries(tool.kind)) continue;
    vibrate(effect, "tools." + tool.name, tool.motion);
    any = true;
  }
  for (SceneBody& body : scene.bodies) {
    if (!body.fixed) continue;
    if (!body.motion) body.motion = Motion{};
    vibrate(effect, "bodies." + body.name, *body.motion);
    any = true;
  }
  if (!any)
    nothing_to_change("base_vibration", "nothing stands on the ground",
                      "it needs a base, plate, floor, box or cup in `tools`, or a body with `fixed: true`");
}

void apply(const MovingWallSpeed& effect, Scene& scene) {
  bool any = scene.layer.has_value();
  if (scene.layer) {
    if (!(effect.factor > 0))
      throw Error("effects.moving_wall_speed.factor", "the spreader of the layer would stand still or go backwards", "give a factor above 0");
    scene.layer->speed *= effect.factor;
  }
  const auto change = [&](Motion& motion) {
    any = any || !motion.velocity.isZero(0) || !motion.angular_velocity.isZero(0);
    motion.velocity *= effect.factor;
    motion.angular_velocity *= effect.factor;
  };
  for (Tool& tool : scene.tools) change(tool.motion);
  for (SceneBody& body : scene.bodies)
    if (body.motion) change(*body.motion);
  if (!any)
    nothing_to_change("moving_wall_speed", "no tool or body has a prescribed velocity",
                      "give one a `motion` with `velocity` or `angular_velocity`");
}

void apply(const GrainShapeFactor& effect, Scene& scene) {
  if (scene.grains.empty()) nothing_to_change("grain_shape", "there are no grains", "add a population to `grains`");
  for (GrainPopulation& grains : scene.grains) {
    grains.aspect *= effect.aspect;
    for (const auto& [shape, share] : grains.mix) {
      try {
        make_grain_shape(shape, scene.proportions.with_aspect(grains.aspect));
      } catch (const Error& error) {
        throw Error("effects.grain_shape.aspect", fmt::format("makes `{}` impossible: {}", shape, error.problem()),
                    error.remedy());
      }
    }
  }
}

void apply(const SizeDistributionFactors& effect, Scene& scene) {
  if (scene.grains.empty())
    nothing_to_change("size_distribution", "there are no grains", "add a population to `grains`");
  for (GrainPopulation& grains : scene.grains) {
    const SizeDistribution before = grains.size;
    change_sizes(grains.size, effect);
    if (reaches_zero(before, grains.size))
      throw Error("effects.size_distribution.sd_factor", "sizes of grains." + grains.name + " reach zero or below",
                  "make it smaller, or narrow the `range` of the sizes");
  }
}

void apply(const InertiaFactor& effect, Scene& scene) {
  scene.inertia_factor = scene.inertia_factor.cwiseProduct(effect.factor);
}

void apply(const CenterOfMassOffset& effect, Scene& scene) { scene.center_of_mass_offset += effect.offset; }

void apply(const ThermalSoftening& effect, Scene& scene) {
  const double factor = std::exp((effect.temperature - softening_reference) / effect.scale);
  if (!std::isfinite(factor))
    throw Error("effects.thermal_softening", "the cohesion becomes infinite", "make the scale larger");
  bool any = false;
  for (auto& [names, law] : scene.pairs) {
    any = any || law.cohesion > 0;
    law.cohesion *= factor;
  }
  if (!any) nothing_to_change("thermal_softening", "no pair has cohesion", "give a pair `cohesion`");
}

void apply(const WallFriction& effect, Scene& scene) {
  bool any = false;
  for (auto& [names, law] : scene.pairs) {
    if (!is_wall_material(scene, names.first) && !is_wall_material(scene, names.second)) continue;
    law.friction = effect.friction;
    any = true;
  }
  if (!any)
    nothing_to_change("wall_friction", "no pair holds a material that only walls have",
                      "give tools and fixed bodies a material of their own, and its pairs a law");
}

}  // namespace repose
