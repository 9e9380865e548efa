#include "analysis/bed_structure.hpp"

#include <algorithm>
#include <map>

#include "analysis/statistics.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

/// fn(index, body) for the grains of the model.
template <class Fn>
void for_each_grain(const Model& model, Fn fn) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (model.bodies[i].role == BodyRole::grain) fn(i, model.bodies[i]);
}

bool holds(const SurfaceRegion& region, const Vec2& at) {
  return (at.array() >= region.lower.array()).all() && (at.array() < region.upper.array()).all();
}

Vec3 highest_point(const GrainPart& part) {
  if (part.is_hull) {
    const Vec3 a = part.centre + Vec3(0, 0, part.radius_a), b = part.centre + part.axis + Vec3(0, 0, part.radius_b);
    return a.z() > b.z() ? a : b;
  }
  // Support point of x^T S^-1 x <= 1 along z.
  return part.centre + part.shape.col(2) / std::sqrt(part.shape(2, 2));
}

/// A stretch of an upright line, inside a grain.
struct Stretch {
  float from, to;
};

/// The stretch of each part over each line, by line, above the plate.
std::vector<std::vector<Stretch>> stretches(const Model& model, const Snapshot& state, const SurfaceRegion& region,
                                            const HeightGrid& lines) {
  std::vector<std::vector<Stretch>> result(lines.height.size());
  for (const GrainPart& part : grain_parts_over(model, state, region)) {
    GrainPart mirrored = part;  // upside down: its top is the bottom
    mirrored.centre.z() *= -1;
    mirrored.axis.z() *= -1;
    mirrored.shape.topRightCorner<2, 1>() *= -1;
    mirrored.shape.bottomLeftCorner<1, 2>() *= -1;
    for_each_cell_under(part, lines, [&](int i, int j, double top) {
      const double bottom = -top_over_point(mirrored, lines.middle(i, j));
      result[lines.index(i, j)].push_back({static_cast<float>(bottom - lines.plate), static_cast<float>(top - lines.plate)});
    });
  }
  return result;
}

/// Sorted, overlaps joined, nothing below the plate.
void merge(std::vector<Stretch>& line) {
  std::sort(line.begin(), line.end(), [](const Stretch& a, const Stretch& b) { return a.from < b.from; });
  std::vector<Stretch> joined;
  for (Stretch s : line) {
    s.from = std::max(0.0f, s.from);
    if (s.to <= s.from) continue;
    if (!joined.empty() && s.from <= joined.back().to)
      joined.back().to = std::max(joined.back().to, s.to);
    else
      joined.push_back(s);
  }
  line = std::move(joined);
}

void add_to_slabs(std::vector<double>& slabs, double slab, double from, double to) {
  for (std::size_t k = static_cast<std::size_t>(from / slab); k < slabs.size() && static_cast<double>(k) * slab < to; ++k) {
    const double low = static_cast<double>(k) * slab;
    slabs[k] += std::max(0.0, std::min(to, low + slab) - std::max(from, low));
  }
}

double share_at(const std::vector<float>& sorted, double share) {
  return sorted.empty() ? 0 : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

/// Error of a ratio of sums over blocks, by leaving out one block at a time (jackknife). nullopt if there are too few, or one holds all.
std::optional<double> ratio_error(const std::vector<double>& upper, const std::vector<double>& lower) {
  const std::size_t n = upper.size();
  if (n < 8) return std::nullopt;
  double a = 0, b = 0, mean = 0, squares = 0;
  for (std::size_t k = 0; k < n; ++k) {
    a += upper[k];
    b += lower[k];
  }
  std::vector<double> left;
  for (std::size_t k = 0; k < n; ++k) left.push_back((a - upper[k]) / (b - lower[k]));
  for (double x : left) mean += x / static_cast<double>(n);
  for (double x : left) squares += (x - mean) * (x - mean);
  if (!std::isfinite(squares)) return std::nullopt;
  return std::sqrt(squares * static_cast<double>(n - 1) / static_cast<double>(n));
}

}  // namespace

double mean_diameter(const Model& model) {
  double sum = 0, n = 0;
  for_each_grain(model, [&](std::size_t, const Body& body) {
    sum += 2 * body.radius;
    n += 1;
  });
  return n > 0 ? sum / n : 0;
}

Vec3 highest_point(const Model& model, const Snapshot& state, int body) {
  Vec3 best(0, 0, -std::numeric_limits<double>::infinity());
  for (const GrainPart& part : grain_parts(model, state, {body}))
    if (const Vec3 top = highest_point(part); top.z() > best.z()) best = top;
  return best;
}

HighestGrains highest_grains(const Model& model, const Snapshot& state, const SurfaceRegion& region, double square) {
  const HeightGrid squares = empty_grid(region, square);
  HighestGrains result{square, squares.nx, squares.ny, {}, {}};
  result.centre.assign(squares.height.size(), std::numeric_limits<double>::quiet_NaN());
  result.top = result.centre;
  const auto raise = [&](std::vector<double>& field, const Vec3& at) {
    const Vec2 place = (at.head<2>() - squares.origin) / square;
    const int i = static_cast<int>(std::floor(place.x())), j = static_cast<int>(std::floor(place.y()));
    if (i < 0 || j < 0 || i >= squares.nx || j >= squares.ny) return;
    double& height = field[squares.index(i, j)];
    height = std::fmax(height, at.z() - region.plate);
  };
  for_each_grain(model, [&](std::size_t i, const Body&) {
    raise(result.centre, state.position[i]);
    raise(result.top, model.periodic.wrapped(highest_point(model, state, static_cast<int>(i))));
  });
  return result;
}

Packing packing_of_bed(const Model& model, const Snapshot& state, const SurfaceRegion& region, double spacing, double slab, double block) {
  if (!(slab > 0) || !(block > 0)) throw Error("layer", "slabs and blocks need a positive size", "");
  const HeightGrid lines = empty_grid(region, spacing);
  std::vector<std::vector<Stretch>> line = stretches(model, state, region, lines);
  double highest = 0;
  for (std::vector<Stretch>& l : line) {
    merge(l);
    if (!l.empty()) highest = std::max<double>(highest, l.back().to);
  }
  Packing p;
  p.slab = slab;
  p.solid.assign(static_cast<std::size_t>(std::ceil(highest / slab)), 0);
  p.below_surface = p.solid;
  const int edge = std::max(1, static_cast<int>(std::ceil(block / spacing)));
  const int across = std::max(1, lines.nx / edge), along = std::max(1, lines.ny / edge);
  std::vector<double> block_solid(static_cast<std::size_t>(across) * static_cast<std::size_t>(along), 0), block_all = block_solid;
  std::vector<float> pores;
  double solid = 0, all = 0;
  for (int j = 0; j < lines.ny; ++j)
    for (int i = 0; i < lines.nx; ++i) {
      const std::vector<Stretch>& l = line[lines.index(i, j)];
      if (l.empty()) continue;
      double length = 0, end = 0;
      for (const Stretch& s : l) {
        length += s.to - s.from;
        add_to_slabs(p.solid, slab, s.from, s.to);
        if (s.from > end) pores.push_back(static_cast<float>(s.from - end));
        end = s.to;
      }
      add_to_slabs(p.below_surface, slab, 0, end);
      solid += length;
      all += end;
      const std::size_t b = static_cast<std::size_t>(std::min(j / edge, along - 1)) * static_cast<std::size_t>(across) +
                            static_cast<std::size_t>(std::min(i / edge, across - 1));
      block_solid[b] += length;
      block_all[b] += end;
    }
  const double n = static_cast<double>(lines.height.size()), area = spacing * spacing;
  for (double& s : p.solid) s /= n * slab;
  for (double& s : p.below_surface) s /= n * slab;
  p.solid_volume = solid * area;
  p.volume = all * area;
  p.area = n * area;
  if (all > 0) p.fraction = solid / all;
  p.se = ratio_error(block_solid, block_all);
  p.pores = pores.size();
  for (float pore : pores) p.pore_mean += pore / static_cast<double>(pores.size());
  std::sort(pores.begin(), pores.end());
  p.pore_median = share_at(pores, 0.5);
  p.pore_p95 = share_at(pores, 0.95);
  return p;
}

Segregation segregation(const Model& model, const Snapshot& state, const SurfaceRegion& region, double bin) {
  if (!(bin > 0)) throw Error("layer", "bins need a positive size", "");
  Segregation result;
  std::map<std::string, std::size_t> kinds;
  for_each_grain(model, [&](std::size_t, const Body& b) { kinds[model.shapes[static_cast<std::size_t>(b.shape)].kind]; });
  for (auto& [kind, index] : kinds) {
    index = result.kinds.size();
    result.kinds.push_back(kind);
  }
  struct Bin {
    std::vector<double> size, of_kind;
  };
  std::map<int, Bin> by_height, by_x;
  constexpr int along_x = 10;
  const double step = (region.upper.x() - region.lower.x()) / along_x;
  for_each_grain(model, [&](std::size_t i, const Body& body) {
    if (!holds(region, state.position[i].head<2>()) || state.position[i].z() < region.plate) return;
    const std::size_t kind = kinds[model.shapes[static_cast<std::size_t>(body.shape)].kind];
    const int h = static_cast<int>((state.position[i].z() - region.plate) / bin);
    const int x = std::min(along_x - 1, static_cast<int>((state.position[i].x() - region.lower.x()) / step));
    for (Bin* b : {&by_height[h], &by_x[x]}) {
      b->of_kind.resize(kinds.size(), 0);
      b->of_kind[kind] += 1;
      b->size.push_back(2 * body.radius);
    }
  });
  const auto told = [](const std::map<int, Bin>& bins, double from, double width) {
    std::vector<SegregationBin> out;
    for (const auto& [k, b] : bins) {
      const Summary size = summarise(b.size);
      const double n = static_cast<double>(size.n);
      SegregationBin s{from + k * width, from + (k + 1) * width, size.n, size.mean, size.se, {}, {}};
      for (double count : b.of_kind) {
        s.share.push_back(count / n);
        s.share_se.push_back(std::sqrt(count / n * (1 - count / n) / n));
      }
      out.push_back(std::move(s));
    }
    return out;
  };
  result.by_height = told(by_height, 0, bin);
  result.by_x = told(by_x, region.lower.x(), step);
  return result;
}

}  // namespace repose
