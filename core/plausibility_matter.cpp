#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/overloaded.hpp"
#include "core/plausibility_checks.hpp"
#include "core/size_sampler.hpp"

namespace repose {
namespace {

// Aerogels and foams begin at tens of kg/m^3, osmium ends the scale at 22,600.
constexpr double absurdly_light = 10, light = 50, heavy = 23'000, absurdly_heavy = 50'000;
// Nothing below 10 nm is a rigid grain; rubble ends at half a metre.
constexpr double absurdly_small = 10e-9, small = 1e-6, large = 50e-3, absurdly_large = 0.5;
constexpr double absurdly_large_body = 1000;
constexpr double widest_size_ratio = 10;  // what the broad phase is made for
constexpr double contacts_per_grain = 3, bytes_per_contact = 400, bytes_per_grain = 700;
constexpr double most_grains = 1e8;

bool needs_density(const Scene& scene, const std::string& material) {
  for (const GrainPopulation& grains : scene.grains)
    if (grains.material == material) return true;
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const SceneBody& body) {
    return body.material == material && !body.fixed && !body.motion && !body.mass;
  });
}

// The power of ten that a slip of unit would explain: 45 -> "45 um".
std::string intended_length(double value) {
  for (const double factor : {1e-6, 1e-3, 1e3})
    if (value * factor >= small && value * factor <= large) return length_text(value * factor);
  return "58 um";
}

double largest_of(const SizeDistribution& size) {
  const double reach = std::visit(
      Overloaded{[](const FixedSize& law) { return law.value; },
                 [](const NormalSize& law) { return law.mean + 4 * law.sd; },
                 [](const LogNormalSize& law) { return law.median * std::exp(4 * law.log_sd); },
                 [](const TableSize& law) { return *std::max_element(law.values.begin(), law.values.end()); }},
      size.law);
  return std::min(reach, size.upper);
}

double smallest_of(const SizeDistribution& size) {
  const double reach = std::visit(
      Overloaded{[](const FixedSize& law) { return law.value; },
                 [](const NormalSize& law) { return law.mean - 4 * law.sd; },
                 [](const LogNormalSize& law) { return law.median * std::exp(-4 * law.log_sd); },
                 [](const TableSize& law) { return *std::min_element(law.values.begin(), law.values.end()); }},
      size.law);
  return std::max(reach, size.lower);
}

void check_density_of_body(const Scene& scene, const SceneBody& body, Findings& findings) {
  const Shape& shape = scene.shapes.at(body.shape);
  if (!body.mass || !(shape.mass.volume > 0)) return;
  const double density = *body.mass / shape.mass.volume;
  const std::string place = "bodies." + body.name + ".mass";
  const std::string found =
      fmt::format("{:.3g} kg in {:.3g} m3 is {:.3g} kg/m3", *body.mass, shape.mass.volume, density);
  if (density < 0.1 || density > absurdly_heavy)
    findings.refuse(place, found + ", which no solid has", "check the units of the mass and of the shape's lengths");
  else if (density < light || density > heavy)
    findings.warn(place, found + ", unusual for a solid", "check the mass and the lengths; a hollow ball may be right");
}

void check_law(const std::string& place, const PairLaw& law, double radius, double weight, Findings& findings) {
  const struct {
    const char* key;
    double value;
  } coefficients[] = {{"friction", law.friction},
                      {"rolling_friction", law.rolling_friction},
                      {"spinning_friction", law.spinning_friction}};
  for (const auto& [key, value] : coefficients) {
    if (value > 10)
      findings.refuse(place + "." + key, fmt::format("{:.4g}; usual values lie between 0 and 1", value),
                      fmt::format("did you mean {:.4g} (percent)?", value / 100));
    else if (value > 1.5)
      findings.warn(place + "." + key, fmt::format("{:.4g}; usual values lie between 0 and 1", value), "check it");
  }
  const struct {
    const char* key;
    double value;
  } arms[] = {{"rolling_friction_length", law.rolling_friction_length},
              {"spinning_friction_length", law.spinning_friction_length}};
  for (const auto& [key, value] : arms) {
    if (radius == 0 || value <= radius) continue;
    const std::string found =
        fmt::format("an arm of {} against a grain radius of {}", length_text(value), length_text(radius));
    if (value > 10 * radius)
      findings.refuse(place + "." + key, found, "this is a length; the dimensionless key has no `_length` at its end");
    else
      findings.warn(place + "." + key, found, "a grain cannot roll with an arm longer than its radius");
  }
  if (law.cohesion > 0 && law.cohesion_range == 0)
    findings.warn(place + ".cohesion_range", "0: cohesion ends with the slightest gap",
                  "give the gap up to which it acts, about 1 % of a grain's radius");
  if (radius > 0 && law.cohesion_range > radius)
    findings.warn(place + ".cohesion_range",
                  fmt::format("{} exceeds a grain's radius", length_text(law.cohesion_range)),
                  "did you mean a hundredth of it?");
  if (weight == 0 || law.cohesion == 0) return;
  const double bond = law.cohesion / weight;
  const std::string found = fmt::format("Bond number c/(m g) = {:.3g} for a grain of mean mass", bond);
  if (bond > 1e6)
    findings.refuse(place + ".cohesion", found,
                    fmt::format("did you mean {:.3g} nN? cohesion is in newtons", law.cohesion));
  else if (bond > 1000)
    findings.warn(place + ".cohesion", found + ": nothing will flow", "check the unit: newtons");
  else
    findings.note(place + ".cohesion", found);
}

}  // namespace

std::string length_text(double metres) {
  const double size = std::abs(metres);
  if (size == 0) return "0 m";
  if (size < 0.9995e-6) return fmt::format("{:.3g} nm", metres * 1e9);
  if (size < 0.9995e-3) return fmt::format("{:.3g} um", metres * 1e6);
  if (size < 0.09995) return fmt::format("{:.3g} mm", metres * 1e3);
  return fmt::format("{:.3g} m", metres);
}

std::vector<PopulationFigures> population_figures(const Scene& scene) {
  std::vector<PopulationFigures> all;
  for (const GrainPopulation& population : scene.grains) {
    PopulationFigures figures;
    figures.population = &population;
    const double mean_cube = SizeSampler(population.size).mean_cube();
    figures.typical = std::cbrt(mean_cube);
    figures.smallest = smallest_of(population.size);
    figures.largest = largest_of(population.size);
    figures.grain_mass = scene.materials.at(population.material).density * std::numbers::pi / 6 * mean_cube;
    figures.count =
        population.count ? static_cast<double>(*population.count) : *population.total_mass / figures.grain_mass;
    all.push_back(figures);
  }
  return all;
}

void check_densities(const Scene& scene, Findings& findings) {
  for (const auto& [name, material] : scene.materials) {
    const std::string place = "materials." + name + ".density";
    const double density = material.density;
    const bool absurd = density < absurdly_light || density > absurdly_heavy;
    if (absurd) {
      const bool grams = density * 1000 >= light && density * 1000 <= heavy;
      const std::string found = fmt::format("{:.4g} kg/m3; solids lie between {} and {}", density, light, heavy);
      const std::string remedy = grams             ? fmt::format("did you mean {:.4g} g/cm3?", density)
                                 : density > heavy ? fmt::format("did you mean {:.4g} kg/m3?", density / 1000)
                                                   : "give the density of the solid in kg/m3, or with a unit";
      if (needs_density(scene, name))
        findings.refuse(place, found, remedy);
      else
        findings.warn(place, found + " (it is not used: no body takes its mass from it)", remedy);
    } else if (density < light || density > heavy) {
      findings.warn(place, fmt::format("{:.4g} kg/m3; solids lie between {} and {}", density, light, heavy),
                    "check it");
    }
  }
  for (const SceneBody& body : scene.bodies) check_density_of_body(scene, body, findings);
}

bool check_sizes(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings) {
  bool sound = true;
  for (const PopulationFigures& g : grains) {
    const std::string place = "grains." + g.population->name + ".size";
    const auto judge = [&](double size, const char* which) {
      const std::string found = fmt::format("{} grains of {}", which, length_text(size));
      const std::string bounds = fmt::format("; grains lie between {} and {}", length_text(small), length_text(large));
      if (size < absurdly_small || size > absurdly_large) {
        findings.refuse(place, found + bounds, fmt::format("did you mean {}?", intended_length(size)));
        sound = false;
        return false;
      }
      if (size < small || size > large)
        findings.warn(place, found + bounds, fmt::format("did you mean {}?", intended_length(size)));
      return size >= small && size <= large;
    };
    // One finding per population is enough.
    if (!judge(g.typical, "typical") || !judge(g.largest, "the largest") || !judge(g.smallest, "the smallest"))
      continue;
    if (g.largest > widest_size_ratio * g.smallest)
      findings.warn(place,
                    fmt::format("sizes from {} to {}: contact search slows down beyond a ratio of {}",
                                length_text(g.smallest), length_text(g.largest), widest_size_ratio),
                    "give a narrower `range`");
  }
  for (const SceneBody& body : scene.bodies) {
    const Shape& shape = scene.shapes.at(body.shape);
    if (body.fixed || body.motion || !shape.bounded()) continue;
    const double size = 2 * shape.bounding_radius;
    const std::string place = "bodies." + body.name + ".shape";
    if (size < absurdly_small || size > absurdly_large_body)
      findings.refuse(place, fmt::format("a body of {}", length_text(size)),
                      fmt::format("did you mean {}? lengths are in metres", intended_length(size)));
    else if (size < small || size > 50)
      findings.warn(place, fmt::format("a body of {}", length_text(size)), "lengths are in metres; check the unit");
  }
  return sound;
}

void check_pairs(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings) {
  for (const auto& [names, law] : scene.pairs) {
    double radius = 0, weight = 0, count = 0;
    for (const PopulationFigures& g : grains) {
      if (g.population->material != names.first && g.population->material != names.second) continue;
      radius = std::max(radius, 0.5 * g.typical);
      weight = std::max(weight, g.grain_mass * scene.gravity.norm());
      count += g.count;
    }
    const std::string place = "pairs." + names.first + "-" + names.second;
    check_law(place, law, radius, weight, findings);
    if (law.restitution > 0.99 && count > 100)
      findings.warn(place + ".restitution", fmt::format("{}: so many grains never come to rest", law.restitution),
                    "real grains lose energy: 0.9 for glass, 0.2 to 0.5 for polymer powder");
  }
}

void check_counts(const std::vector<PopulationFigures>& grains, Findings& findings) {
  double total = 0;
  for (const PopulationFigures& g : grains) {
    const std::string key = g.population->count ? ".count" : ".mass";
    if (g.count < 0.5)
      findings.refuse(
          "grains." + g.population->name + key,
          fmt::format("{:.3g} kg is less than one grain of {:.3g} kg", *g.population->total_mass, g.grain_mass),
          "give a larger mass, or a `count`");
    if (!g.population->count)
      findings.note("grains." + g.population->name + key, fmt::format("about {:.0f} grains", g.count));
    total += g.count;
  }
  if (total == 0) return;
  const double bytes = total * (bytes_per_grain + contacts_per_grain * bytes_per_contact);
  const double present = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  const std::string found =
      fmt::format("{:.4g} grains need about {:.3g} GB; this machine has {:.3g} GB", total, bytes / 1e9, present / 1e9);
  const std::string fewer = fmt::format("simulate a smaller apparatus: {:.0e} grains fit",
                                        std::min(most_grains, 0.5 * present / (bytes / total)));
  if (total > most_grains || bytes > present)
    findings.refuse("grains", found, fewer);
  else if (bytes > 0.5 * present)
    findings.warn("grains", found, fewer);
  else
    findings.note("grains", fmt::format("{:.0f} grains, about {:.0f} MB of memory", total, std::ceil(bytes / 1e6)));
}

}  // namespace repose
