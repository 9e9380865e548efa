#include "analysis/roughness.hpp"

#include <algorithm>
#include <numbers>
#include <random>

#include "core/areal_filter.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

/// fn(i, j, height) over the cells that are no holes.
template <class Fn>
void for_each_cell(const HeightGrid& grid, Fn fn) {
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i)
      if (!grid.is_hole(i, j)) fn(i, j, static_cast<double>(grid.at(i, j)));
}

Vec2 from_middle(const HeightGrid& grid, int i, int j) {
  return grid.cell * Vec2(i + 0.5 - 0.5 * grid.nx, j + 0.5 - 0.5 * grid.ny);
}

/// Sums over cells, and the figures that follow from them.
struct Moments {
  double n = 0, first = 0, second = 0, third = 0, fourth = 0, absolute = 0;
  double sides = 0;  // cells above less cells below

  void add(double z, double offset) {
    const double d = z - offset;
    n += 1;
    first += d;
    second += d * d;
    third += d * d * d;
    fourth += d * d * d * d;
    absolute += std::abs(d);
    sides += (d > 0) - (d < 0);
  }
  void operator+=(const Moments& o) {
    n += o.n;
    first += o.first;
    second += o.second;
    third += o.third;
    fourth += o.fourth;
    absolute += o.absolute;
    sides += o.sides;
  }
  /// The same cells about their own mean; the absolute values to first order in its distance.
  Moments about_mean() const {
    const double m = first / n;
    return {n,
            0,
            second - n * m * m,
            third - 3 * m * second + 2 * n * m * m * m,
            fourth - 4 * m * third + 6 * m * m * second - 3 * n * m * m * m * m,
            absolute - m * sides,
            sides};
  }
  double Sq() const { return std::sqrt(second / n); }
  double Sa() const { return absolute / n; }
  double Ssk() const { return second > 0 ? third / n / std::pow(Sq(), 3) : 0; }
  double Sku() const { return second > 0 ? fourth / n / std::pow(Sq(), 4) : 0; }
};

double mean_height(const HeightGrid& grid) {
  double sum = 0, n = 0;
  for_each_cell(grid, [&](int, int, double z) {
    sum += z;
    n += 1;
  });
  if (n == 0) throw Error("roughness", "the surface has nothing but holes", "look at a region that grains cover");
  return sum / n;
}

/// One pass of a separable mean: sums along one direction, `stride` apart.
void smear(const std::vector<double>& in, std::vector<double>& out, int lines, int length, std::size_t line_stride, std::size_t stride,
           const std::vector<double>& weight) {
  const int reach = static_cast<int>(weight.size()) - 1;
  for (int line = 0; line < lines; ++line) {
    const std::size_t base = static_cast<std::size_t>(line) * line_stride;
    for (int i = 0; i < length; ++i) {
      double sum = 0;
      for (int k = std::max(0, i - reach); k <= std::min(length - 1, i + reach); ++k)
        sum += weight[static_cast<std::size_t>(std::abs(k - i))] * in[base + static_cast<std::size_t>(k) * stride];
      out[base + static_cast<std::size_t>(i) * stride] = sum;
    }
  }
}

/// Mean over the pairs of cells that are `lag` apart.
double covariance(const HeightGrid& grid, double mean, int dx, int dy) {
  double sum = 0, n = 0;
  for (int j = std::max(0, -dy); j < grid.ny - std::max(0, dy); ++j)
    for (int i = 0; i < grid.nx - dx; ++i) {
      const float a = grid.at(i, j), b = grid.at(i + dx, j + dy);
      if (std::isnan(a) || std::isnan(b)) continue;
      sum += (a - mean) * (b - mean);
      n += 1;
    }
  return n > 0 ? sum / n : 0;
}

}  // namespace

Plane fit_plane(const HeightGrid& surface) {
  Mat3 normal = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  const double scale = surface.cell * std::max(surface.nx, surface.ny);
  for_each_cell(surface, [&](int i, int j, double z) {
    const Vec2 at = from_middle(surface, i, j) / scale;
    const Vec3 row(1, at.x(), at.y());
    normal += row * row.transpose();
    right += z * row;
  });
  const Eigen::FullPivLU<Mat3> solver(normal);
  if (solver.rank() < 3)
    throw Error("roughness", "too few cells have a height to lay a plane through them", "look at a region that grains cover");
  const Vec3 found = solver.solve(right);
  return {found.x(), Vec2(found.y(), found.z()) / scale};
}

HeightGrid without(const HeightGrid& surface, const Plane& plane) {
  HeightGrid out = surface;
  for_each_cell(surface, [&](int i, int j, double z) {
    out.height[out.index(i, j)] = static_cast<float>(z - plane.height - plane.slope.dot(from_middle(surface, i, j)));
  });
  return out;
}

HeightGrid gaussian_mean(const HeightGrid& surface, double lambda) {
  if (!(lambda >= least_filter_cells * surface.cell))
    throw Error("roughness", "a filter needs a nesting index of three cells or more", "make it longer or the cells smaller, or leave it out for none");
  const double width = std::sqrt(std::numbers::ln2 / std::numbers::pi) * lambda;
  std::vector<double> weight;
  for (int k = 0; k * surface.cell <= lambda || k == 0; ++k)
    weight.push_back(std::exp(-std::numbers::pi * std::pow(k * surface.cell / width, 2)));

  const std::size_t cells = surface.height.size(), nx = static_cast<std::size_t>(surface.nx);
  std::vector<double> value(cells, 0), there(cells, 0), turn(cells);
  for_each_cell(surface, [&](int i, int j, double z) {
    value[surface.index(i, j)] = z;
    there[surface.index(i, j)] = 1;
  });
  for (std::vector<double>* field : {&value, &there}) {
    smear(*field, turn, surface.ny, surface.nx, nx, 1, weight);
    smear(turn, *field, surface.nx, surface.ny, 1, nx, weight);
  }
  HeightGrid out = surface;
  for_each_cell(surface, [&](int i, int j, double) {
    const std::size_t k = surface.index(i, j);
    out.height[k] = static_cast<float>(value[k] / there[k]);
  });
  return out;
}

HeightGrid prepared_surface(const HeightGrid& surface, const RoughnessFilter& filter) {
  HeightGrid out = without(surface, fit_plane(surface));
  if (filter.s > 0) out = gaussian_mean(out, filter.s);
  if (filter.l > 0) {
    const HeightGrid longer = gaussian_mean(out, filter.l);
    for (std::size_t k = 0; k < out.height.size(); ++k) out.height[k] -= longer.height[k];
  }
  return out;
}

Roughness roughness(const HeightGrid& prepared) {
  const double mean = mean_height(prepared);
  Moments moments;
  Roughness r;
  for_each_cell(prepared, [&](int, int, double z) {
    moments.add(z, mean);
    r.Sp = std::max(r.Sp, z - mean);
    r.Sv = std::max(r.Sv, mean - z);
  });
  r.Sa = moments.Sa();
  r.Sq = moments.Sq();
  r.Sz = r.Sp + r.Sv;
  if (moments.second > 0) {
    r.Ssk = moments.Ssk();
    r.Sku = moments.Sku();
  }
  return r;
}

std::optional<double> autocorrelation_length(const HeightGrid& prepared, double most_products) {
  constexpr double fallen = 0.2;
  const double mean = mean_height(prepared), variance = covariance(prepared, mean, 0, 0);
  if (!(variance > 0)) return std::nullopt;
  // Half a disc of lags, a product for each cell.
  const double affordable = std::sqrt(2 / std::numbers::pi * most_products / static_cast<double>(prepared.height.size()));
  const int reach = static_cast<int>(std::min(0.5 * std::min(prepared.nx, prepared.ny), affordable));

  // Lags of the half plane dx >= 0, by length: the first that has fallen bounds the answer.
  struct Lag {
    int dx, dy;
    double length;
  };
  std::vector<Lag> lags;
  for (int dx = 0; dx <= reach; ++dx)
    for (int dy = dx == 0 ? 1 : -reach; dy <= reach; ++dy)
      if (const double length = std::hypot(dx, dy); length <= reach) lags.push_back({dx, dy, length});
  std::sort(lags.begin(), lags.end(), [](const Lag& a, const Lag& b) { return a.length < b.length; });

  const std::size_t span = 2 * static_cast<std::size_t>(reach) + 1;
  std::vector<double> known((static_cast<std::size_t>(reach) + 1) * span, 2);  // 2: not computed yet
  const auto correlation = [&](int dx, int dy) {
    if (dx < 0) {
      dx = -dx;
      dy = -dy;
    }
    if (dx == 0) dy = std::abs(dy);
    double& value = known[static_cast<std::size_t>(dx) * span + static_cast<std::size_t>(dy + reach)];
    if (value == 2) value = covariance(prepared, mean, dx, dy) / variance;
    return value;
  };
  // One cell nearer to the origin on the same ray, between the four lags around it.
  const auto nearer = [&](const Lag& lag) {
    const double share = 1 - 1 / lag.length, x = lag.dx * share, y = lag.dy * share;
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    const double u = x - i, v = y - j;
    double sum = 0;
    if (u < 1 && v < 1) sum += (1 - u) * (1 - v) * correlation(i, j);
    if (u > 0) sum += u * (1 - v) * correlation(std::min(i + 1, reach), j);
    if (v > 0) sum += (1 - u) * v * correlation(i, std::min(j + 1, reach));
    if (u > 0 && v > 0) sum += u * v * correlation(std::min(i + 1, reach), std::min(j + 1, reach));
    return sum;
  };
  std::optional<double> shortest;
  for (const Lag& lag : lags) {
    if (shortest && lag.length > *shortest / prepared.cell + 1) break;
    const double here = correlation(lag.dx, lag.dy);
    if (here > fallen) continue;
    const double before = nearer(lag);
    const double length = before > fallen ? lag.length - (fallen - here) / (before - here) : lag.length - 1;
    shortest = std::min(shortest.value_or(length * prepared.cell), length * prepared.cell);
  }
  return shortest;
}

std::optional<RoughnessError> block_bootstrap(const HeightGrid& surface, const HeightGrid& prepared, double block) {
  const int edge = std::max(1, static_cast<int>(std::ceil(block / surface.cell)));
  const int across = surface.nx / edge, along = surface.ny / edge;
  if (across * along < 8) return std::nullopt;
  struct Block {
    Moments heights, shape;
  };
  std::vector<Block> blocks(static_cast<std::size_t>(across) * static_cast<std::size_t>(along));
  const double mean = mean_height(prepared), level = mean_height(surface);
  for_each_cell(surface, [&](int i, int j, double z) {
    const int bx = i / edge, by = j / edge;
    if (bx >= across || by >= along) return;
    Block& b = blocks[static_cast<std::size_t>(by) * static_cast<std::size_t>(across) + static_cast<std::size_t>(bx)];
    b.heights.add(z, level);
    b.shape.add(prepared.at(i, j), mean);
  });
  constexpr int draws = 200;
  std::mt19937_64 random(1);
  std::vector<std::array<double, 5>> drawn;
  for (int d = 0; d < draws; ++d) {
    Moments heights, shape;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const Block& b = blocks[random() % blocks.size()];
      heights += b.heights;
      shape += b.shape;
    }
    if (!(shape.n > 0)) continue;
    shape = shape.about_mean();  // as roughness() takes its heights
    drawn.push_back({heights.first / heights.n, shape.Sa(), shape.Sq(), shape.Ssk(), shape.Sku()});
  }
  std::array<double, 5> scatter{};
  for (std::size_t k = 0; k < scatter.size(); ++k) {
    double sum = 0, squares = 0;
    for (const auto& d : drawn) sum += d[k];
    const double centre = sum / static_cast<double>(drawn.size());
    for (const auto& d : drawn) squares += (d[k] - centre) * (d[k] - centre);
    scatter[k] = std::sqrt(squares / static_cast<double>(drawn.size() - 1));
  }
  Moments all;
  for (const Block& b : blocks) all += b.shape;
  RoughnessError error{scatter[0], scatter[1], scatter[2], std::nullopt, std::nullopt, across * along};
  if (all.second > 0) {
    error.Ssk = scatter[3];
    error.Sku = scatter[4];
  }
  return error;
}

HeightFigures height_figures(std::vector<double> heights) {
  std::erase_if(heights, [](double z) { return std::isnan(z); });
  HeightFigures f;
  f.n = heights.size();
  if (heights.empty()) return f;
  std::sort(heights.begin(), heights.end());
  const double n = static_cast<double>(f.n);
  for (double z : heights) f.mean += z / n;
  double squares = 0;
  for (double z : heights) squares += (z - f.mean) * (z - f.mean);
  f.sd = f.n > 1 ? std::sqrt(squares / (n - 1)) : 0;
  f.min = heights.front();
  f.max = heights.back();
  for (std::size_t k = 0; k < told_shares.size(); ++k) {
    const double place = told_shares[k] * (n - 1);
    const std::size_t below = static_cast<std::size_t>(place), above = std::min(below + 1, f.n - 1);
    f.quantile[k] = heights[below] + (place - static_cast<double>(below)) * (heights[above] - heights[below]);
  }
  return f;
}

HeightFigures height_figures(const HeightGrid& surface) {
  return height_figures(std::vector<double>(surface.height.begin(), surface.height.end()));
}

}  // namespace repose
