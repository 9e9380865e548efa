#include "analysis/packing.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "analysis/neighbour_grid.hpp"
#include "analysis/statistics.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

constexpr int sector_count = 8;

// Kronecker sequence x_n = frac(n a), a = (1/p, 1/p^2, 1/p^3), p^4 = p + 1.
Vec3 spread_point(int n) {
  constexpr double p = 1.2207440846057596;
  const auto part = [&](double a) {
    const double x = 0.5 + a * n;
    return x - std::floor(x);
  };
  return {part(1 / p), part(1 / (p * p)), part(1 / (p * p * p))};
}

class GrainField {
 public:
  GrainField(const Model& model, const Snapshot& state, const std::vector<int>& bodies)
      : model_(model),
        state_(state),
        images_(images(model, state, bodies)),
        grid_(places(images_), largest(model, bodies)) {}

  bool solid_at(const Vec3& anywhere) const {
    const Vec3 point = model_.periodic.wrapped(anywhere);
    bool inside = false;
    grid_.near(point, [&](int k) {
      const Image& image = images_[static_cast<std::size_t>(k)];
      const Body& body = model_.bodies[image.body];
      const Vec3 local = state_.orientation[image.body].conjugate() * (point - image.place) / body.scale;
      const Shape& shape = model_.shapes[static_cast<std::size_t>(body.shape)];
      inside = local.norm() <= shape.bounding_radius && contains(shape, local);
      return !inside;
    });
    return inside;
  }

 private:
  /// A body, or in a periodic cell one of its images that reach into the cell.
  struct Image {
    std::size_t body;
    Vec3 place;
  };
  static std::vector<Image> images(const Model& model, const Snapshot& state, const std::vector<int>& bodies) {
    const double reach = largest(model, bodies);
    std::vector<Image> result;
    for (int b : bodies)
      model.periodic.each_image(state.position[static_cast<std::size_t>(b)], reach, [&](const Vec3& place) {
        result.push_back({static_cast<std::size_t>(b), place});
        return true;
      });
    return result;
  }
  static std::vector<Vec3> places(const std::vector<Image>& images) {
    std::vector<Vec3> result;
    for (const Image& image : images) result.push_back(image.place);
    return result;
  }
  static double largest(const Model& model, const std::vector<int>& bodies) {
    double r = 0;
    for (int b : bodies) {
      const Body& body = model.bodies[static_cast<std::size_t>(b)];
      r = std::max(r, body.scale * model.shapes[static_cast<std::size_t>(body.shape)].bounding_radius);
    }
    return r > 0 ? r : 1;
  }

  const Model& model_;
  const Snapshot& state_;
  std::vector<Image> images_;
  NeighbourGrid grid_;
};

// Spreads points over the cylinder until `points` of them are accepted or the accepted share is below 1/1000.
template <class Accept>
std::optional<SolidFraction> sample(const GrainField& field, const Vec3& base, double radius, double height, int points,
                                    Accept accept) {
  if (!(radius > 0) || !(height > 0) || points < 1)
    throw Error("packing", "the region needs a positive radius, height and number of points", "");
  std::array<double, sector_count> inside{}, solid{};
  int tried = 0, accepted = 0;
  while (accepted < points) {
    if (tried >= 1000 && accepted < tried / 1000) return std::nullopt;
    const Vec3 u = spread_point(tried++);
    const double r = radius * std::sqrt(u.x()), angle = 2 * std::numbers::pi * u.y();
    const Vec3 point = base + Vec3(r * std::cos(angle), r * std::sin(angle), height * u.z());
    if (!accept(point, r)) continue;
    ++accepted;
    const std::size_t sector = std::min<std::size_t>(sector_count - 1, static_cast<std::size_t>(u.y() * sector_count));
    inside[sector] += 1;
    solid[sector] += field.solid_at(point);
  }
  double all_inside = 0, all_solid = 0;
  std::vector<double> sectors;
  for (std::size_t s = 0; s < sector_count; ++s) {
    all_inside += inside[s];
    all_solid += solid[s];
    if (inside[s] > 0) sectors.push_back(solid[s] / inside[s]);
  }
  const Summary scatter = summarise(sectors);
  return SolidFraction{all_solid / all_inside, scatter.sd, scatter.se,
                       std::numbers::pi * radius * radius * height * accepted / tried};
}

// Mean height of the map over a square of edge 2 * half around each column.
class SmoothSurface {
 public:
  SmoothSurface(const HeightMap& map, double half) : map_(map), reach_(static_cast<int>(std::ceil(half / map.pixel))) {
    const std::size_t n = static_cast<std::size_t>(map.size) + 1;
    sum_.assign(n * n, 0);
    for (std::size_t j = 1; j < n; ++j)
      for (std::size_t i = 1; i < n; ++i)
        sum_[j * n + i] = map.at(static_cast<int>(i) - 1, static_cast<int>(j) - 1) + sum_[(j - 1) * n + i] +
                          sum_[j * n + i - 1] - sum_[(j - 1) * n + i - 1];
  }
  double at(const Vec2& place) const {
    const Vec2 c = (place - map_.origin) / map_.pixel;
    const auto low = [&](double x) { return static_cast<std::size_t>(std::clamp(static_cast<int>(x) - reach_, 0, map_.size - 1)); };
    const auto high = [&](double x) { return static_cast<std::size_t>(std::clamp(static_cast<int>(x) + reach_ + 1, 1, map_.size)); };
    const std::size_t n = static_cast<std::size_t>(map_.size) + 1;
    const std::size_t i0 = low(c.x()), i1 = high(c.x()), j0 = low(c.y()), j1 = high(c.y());
    const double total = sum_[j1 * n + i1] - sum_[j0 * n + i1] - sum_[j1 * n + i0] + sum_[j0 * n + i0];
    return total / (static_cast<double>(i1 - i0) * static_cast<double>(j1 - j0));
  }

 private:
  const HeightMap& map_;
  int reach_;
  std::vector<double> sum_;
};

}  // namespace

std::optional<SolidFraction> heap_solid_fraction(const Model& model, const Snapshot& state, const HeapGrains& grains,
                                                 const HeapSite& site, const HeightMap& map, double margin, int points) {
  if (!(margin >= 0)) throw Error("packing", "the margin must not be negative", "");
  const double away = margin * grains.diameter;
  double highest = 0;
  for (double h : map.height) highest = std::max(highest, h);
  if (grains.heap.empty() || highest <= 2 * away || site.radius <= away) return std::nullopt;
  const SmoothSurface surface(map, away);
  const GrainField field(model, state, grains.heap);
  return sample(field, site.centre + Vec3(0, 0, away), site.radius - away, highest - 2 * away, points,
                [&](const Vec3& point, double) {
                  return point.z() - site.centre.z() < surface.at(point.head<2>()) - away;
                });
}

SolidFraction solid_fraction_in_cylinder(const Model& model, const Snapshot& state, const std::vector<int>& bodies,
                                         const Vec3& base, double radius, double height, int points) {
  const GrainField field(model, state, bodies);
  return *sample(field, base, radius, height, points, [](const Vec3&, double) { return true; });
}

double heap_volume(const HeightMap& map) {
  double sum = 0;
  for (double h : map.height) sum += h;
  return sum * map.pixel * map.pixel;
}

}  // namespace repose
