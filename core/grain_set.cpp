#include "core/grain_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/ball_grid.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

/// A stream of its own for each purpose: FNV-1a of the text, mixed with the seed by SplitMix64 (Steele et al. 2014).
std::uint64_t derived_seed(std::uint64_t seed, const std::string& purpose) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : purpose) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  std::uint64_t z = seed + 0x9e3779b97f4a7c15ULL * (hash | 1);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// Above this, indices of bodies and contacts no longer fit in 32 bits.
constexpr std::size_t most_grains = 200'000'000;

void refuse_too_many(const GrainPopulation& population, double count) {
  if (count <= static_cast<double>(most_grains)) return;
  throw Error("grains." + population.name, fmt::format("this asks for {:.3g} grains", count),
              "a machine holds some millions: reduce count or mass, or make the grains larger");
}

/// Calls `make`; an Error that names a key below `place` gets its full path.
auto within(const std::string& place, const auto& make) {
  try {
    return make();
  } catch (const Error& error) {
    throw Error(error.place().empty() ? place : place + "." + error.place(), error.problem(), error.remedy(),
                error.kind());
  }
}

/// Volume of a grain: that of the sphere of its size, whatever its shape [m^3].
double volume(const GrainKind& grain) { return std::numbers::pi / 6 * grain.size * grain.size * grain.size; }

/// Draws until the mass is reached: the last grain is the one that reaches it.
std::vector<GrainKind> draw_mass(const GrainPopulation& population, double density, const std::vector<double>& shares,
                                 std::uint64_t seed) {
  const double wanted = *population.total_mass / density;
  std::size_t count = 64;
  while (true) {
    std::vector<GrainKind> grains = within("grains." + population.name, [&] {
      return draw_grains(population.size, shares, population.mix_by_mass, count, seed);
    });
    double sum = 0;
    for (std::size_t i = 0; i < grains.size(); ++i) {
      sum += volume(grains[i]);
      if (sum < wanted) continue;
      grains.resize(i + 1);
      return grains;
    }
    const double needed = 1.02 * static_cast<double>(count) * wanted / sum + 64;
    refuse_too_many(population, needed);
    count = static_cast<std::size_t>(needed);
  }
}

/// The shapes that populations share: the same name at the same aspect is made once.
class ShapeTable {
 public:
  ShapeTable(const GrainProportions& proportions, std::vector<Shape>& shapes)
      : proportions_(proportions), shapes_(shapes) {}

  int index(const std::string& name, double aspect) {
    const auto [entry, is_new] = known_.try_emplace({name, aspect}, static_cast<int>(shapes_.size()));
    if (is_new) shapes_.push_back(make_grain_shape(name, proportions_.with_aspect(aspect)));
    return entry->second;
  }

 private:
  GrainProportions proportions_;
  std::vector<Shape>& shapes_;
  std::map<std::pair<std::string, double>, int> known_;
};

void draw_population(const Scene& scene, int index, std::uint64_t seed, ShapeTable& table, GrainSet& set) {
  const GrainPopulation& population = scene.grains[static_cast<std::size_t>(index)];
  const std::string place = "grains." + population.name;
  std::vector<int> shapes;
  std::vector<double> shares;
  for (const auto& [name, share] : population.mix) {
    if (!(share >= 0) || !std::isfinite(share))
      throw Error(place + ".mix." + name, "a share must be zero or more", "shares are relative: {sphere: 2, twin: 1}");
    if (share == 0) continue;
    shapes.push_back(within(place, [&, &key = name] { return table.index(key, population.aspect); }));
    shares.push_back(share);
  }
  if (shapes.empty()) throw Error(place + ".mix", "no shape has a share", "write for example mix: {sphere: 1}");
  if (population.count.has_value() == population.total_mass.has_value())
    throw Error(place, "exactly one of count and mass is needed", "give the number of grains or their mass");

  const std::uint64_t stream = derived_seed(seed, "draw " + population.name);
  std::vector<GrainKind> kinds;
  if (population.count) {
    refuse_too_many(population, static_cast<double>(*population.count));
    kinds = within(
        place, [&] { return draw_grains(population.size, shares, population.mix_by_mass, *population.count, stream); });
  } else {
    const auto material = scene.materials.find(population.material);
    if (material == scene.materials.end())
      throw Error(place + ".material", "there is no material " + population.material, "add it to materials");
    if (!(*population.total_mass > 0))
      throw Error(place + ".mass", "the mass must be positive", "give a mass above zero, for example \"5 g\"");
    kinds = draw_mass(population, material->second.density, shares, stream);
  }
  for (const GrainKind& kind : kinds)
    set.grains.push_back({index, shapes[static_cast<std::size_t>(kind.shape)], kind.size, {}});
}

bool same_region(const FillRegion& a, const FillRegion& b) {
  return a.kind == b.kind && a.lower == b.lower && a.upper == b.upper && a.base == b.base &&
         a.radius_bottom == b.radius_bottom && a.radius_top == b.radius_top && a.height == b.height && a.grow == b.grow;
}

/// For each population the first one with the same region: the group it is placed with.
std::vector<int> fill_groups(const std::vector<GrainPopulation>& populations) {
  std::vector<int> group(populations.size());
  for (std::size_t i = 0; i < populations.size(); ++i) {
    std::size_t first = 0;
    while (first < i && !same_region(populations[first].fill, populations[i].fill)) ++first;
    group[i] = static_cast<int>(first);
  }
  return group;
}

/// A hair more than the ball that holds the grain, so that rounding cannot make two grains overlap.
double ball_radius(const GrainSet& set, const PlacedGrain& grain) {
  return set.shapes[static_cast<std::size_t>(grain.shape)].bounding_radius * grain.size * (1 + 1e-6);
}

void place_group(const Scene& scene, int group, const std::vector<int>& group_of, std::uint64_t seed, GrainSet& set) {
  std::vector<std::size_t> members;
  std::vector<double> radii;
  for (std::size_t i = 0; i < set.grains.size(); ++i) {
    if (group_of[static_cast<std::size_t>(set.grains[i].population)] != group) continue;
    members.push_back(i);
    radii.push_back(ball_radius(set, set.grains[i]));
  }
  if (members.empty()) return;
  const GrainPopulation& first = scene.grains[static_cast<std::size_t>(group)];
  const std::vector<Placement> placements = within("grains." + first.name, [&] {
    return place_balls(first.fill, radii, derived_seed(seed, "place " + first.name), scene.periodic);
  });
  for (std::size_t k = 0; k < members.size(); ++k) set.grains[members[k]].placement = placements[k];
}

/// Grains of different groups were placed without knowing of each other.
void refuse_overlap_between_groups(const Scene& scene, const std::vector<int>& group_of, const GrainSet& set) {
  if (std::all_of(group_of.begin(), group_of.end(), [&](int g) { return g == group_of.front(); })) return;
  double largest = 0;
  Vec3 corner = set.grains.front().placement.position;
  for (const PlacedGrain& grain : set.grains) {
    largest = std::max(largest, ball_radius(set, grain));
    corner = corner.cwiseMin(grain.placement.position);
  }
  std::map<int, BallGrid> grids;
  for (const PlacedGrain& grain : set.grains) {
    const auto population = static_cast<std::size_t>(grain.population);
    const int own = group_of[population];
    const Vec3& centre = grain.placement.position;
    const double radius = ball_radius(set, grain);
    for (const auto& [group, grid] : grids)
      if (group != own && !scene.periodic.each_image(centre, radius + largest, [&, &balls = grid](const Vec3& image) {
            return balls.free(image - corner, radius);
          }))
        throw Error("grains." + scene.grains[population].name + ".fill",
                    "its grains overlap those of grains." + scene.grains[static_cast<std::size_t>(group)].name,
                    "move the regions apart, or give both the same fill to mix them");
    grids.try_emplace(own, largest, set.grains.size()).first->second.add(centre - corner, radius);
  }
}

}  // namespace

GrainSet make_grains(const Scene& scene, std::uint64_t seed) {
  GrainSet set;
  ShapeTable table(scene.proportions, set.shapes);
  for (std::size_t i = 0; i < scene.grains.size(); ++i) draw_population(scene, static_cast<int>(i), seed, table, set);
  if (set.grains.empty()) return set;
  if (set.grains.size() > most_grains) refuse_too_many(scene.grains.front(), static_cast<double>(set.grains.size()));

  const std::vector<int> group_of = fill_groups(scene.grains);
  for (std::size_t i = 0; i < group_of.size(); ++i)
    if (group_of[i] == static_cast<int>(i)) place_group(scene, group_of[i], group_of, seed, set);
  refuse_overlap_between_groups(scene, group_of, set);

  double sum = 0;
  for (const PlacedGrain& grain : set.grains) sum += grain.size;
  set.mean_size = sum / static_cast<double>(set.grains.size());
  return set;
}

}  // namespace repose
