#include "core/fill.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/ball_grid.hpp"
#include "core/error.hpp"
#include "core/random.hpp"

namespace repose {
namespace {

constexpr double aimed_fraction = 0.25;  // random sequential addition gets slow above 0.3 and jams at 0.38
constexpr int tries_before_growth = 500;
constexpr int tries_before_giving_up = 20'000;  // for one ball
constexpr std::size_t mean_tries = 200;         // for all of them; 15 are usual at the fraction aimed at
constexpr double growth = 1.05;

/// True if a box goes from one side of the periodic cell to the other.
bool spans(const FillRegion& region, const PeriodicCell& cell, int axis) {
  const double rounding = 1e-9 * cell.length(axis);
  return region.kind == FillRegion::Kind::box && std::abs(region.lower[axis] - cell.lower[axis]) <= rounding &&
         std::abs(region.upper[axis] - cell.upper[axis]) <= rounding;
}

/// The region at its present height.
class Room {
 public:
  Room(const FillRegion& region, const PeriodicCell& cell) : region_(region) {
    for (int k = 0; k < 2; ++k) open_[k] = cell.along(k) && spans(region, cell, k);
    if (box()) {
      height_ = region.upper.z() - region.lower.z();
    } else {
      height_ = region.height;
      slope_ = (region.radius_top - region.radius_bottom) / region.height;
      slant_ = std::hypot(1.0, slope_);
    }
  }

  double height() const { return height_; }
  void set_height(double height) { height_ = height; }

  double volume() const { return volume(height_); }

  /// The height at which the room has this volume [m], at least the present one.
  double height_for(double wanted) const {
    const double missing = wanted - volume();
    if (!(missing > 0)) return height_;
    const double r = region_.radius_top;
    return height_ + missing / (box() ? width().x() * width().y() : std::numbers::pi * r * r);
  }

  /// Radius of the largest ball that the room can hold if only its height may change [m].
  double widest(bool any_height) const {
    if (box()) return 0.5 * std::min({width().x(), width().y(), any_height ? width().x() : height_});
    const double r = region_.radius_bottom, top = region_.radius_top;
    if (any_height && slope_ >= 0) return top;
    // The ball that touches the wall, and the lid (widening) or the floor (narrowing).
    const double within = slope_ >= 0 ? top / (slope_ + slant_) : r / (slant_ - slope_);
    return any_height ? std::max(within, top) : std::min(within, 0.5 * height_);
  }

  /// A place for the centre of a ball of radius r, uniform in the box about all places; false if the wall is in the
  /// way.
  bool propose(double r, Random& random, Vec3& centre) const {
    if (box()) {
      for (int i = 0; i < 2; ++i) {
        const double wall = open_[i] ? 0 : r;
        centre[i] = random.uniform(region_.lower[i] + wall, region_.upper[i] - wall);
      }
      centre.z() = region_.lower.z() + random.uniform(r, height_ - r);
      return true;
    }
    const double most = std::max(reach(r, r), reach(r, height_ - r));
    if (most < 0) return false;
    const double x = random.uniform(-most, most), y = random.uniform(-most, most), z = random.uniform(r, height_ - r);
    centre = region_.base + Vec3(x, y, z);
    const double allowed = reach(r, z);
    return allowed >= 0 && x * x + y * y <= allowed * allowed;
  }

 private:
  bool box() const { return region_.kind == FillRegion::Kind::box; }
  Vec3 width() const { return region_.upper - region_.lower; }

  double volume(double height) const {
    if (box()) return width().x() * width().y() * height;
    const double a = region_.radius_bottom, b = region_.radius_top;
    return std::numbers::pi * (region_.height * (a * a + a * b + b * b) / 3 + (height - region_.height) * b * b);
  }

  // How far from the axis the centre of a ball of radius r may be at height z: clear of the cone's wall and, once the
  // frustum has grown, of the cylinder on top of it. Where the wall narrows upward it is enough to be clear of either.
  double reach(double r, double z) const {
    const double cone = region_.radius_bottom + slope_ * z - r * slant_;
    if (height_ <= region_.height) return cone;
    const double cylinder = region_.radius_top - r;
    return slope_ >= 0 ? std::min(cone, cylinder) : std::max(cone, cylinder);
  }

  FillRegion region_;
  bool open_[2] = {false, false};  ///< no walls across x, y: the region goes on in the next cell
  double height_ = 0, slope_ = 0, slant_ = 1;
};

void keep_within(const PeriodicCell& cell, const FillRegion& region) {
  for (int k = 0; k < 2; ++k) {
    if (!cell.along(k) || spans(region, cell, k)) continue;
    const bool box = region.kind == FillRegion::Kind::box;
    const double radius = std::max(region.radius_bottom, region.radius_top);
    const double low = box ? region.lower[k] : region.base[k] - radius;
    const double high = box ? region.upper[k] : region.base[k] + radius;
    if (low >= cell.lower[k] && high <= cell.upper[k]) continue;
    throw Error("fill",
                fmt::format("the region reaches from {0} = {1:.4g} to {2:.4g} m, out of the periodic cell from {3:.4g} to "
                            "{4:.4g} m",
                            k == 0 ? "x" : "y", low, high, cell.lower[k], cell.upper[k]),
                "keep it within the cell; a box from one side of the cell to the other is filled across the seam");
  }
}

void validate(const FillRegion& region, std::span<const double> radii) {
  if (region.kind == FillRegion::Kind::box) {
    const Vec3 width = region.upper - region.lower;
    if (!region.lower.allFinite() || !region.upper.allFinite() || !(width.minCoeff() > 0))
      throw Error("fill",
                  fmt::format("the box from [{}, {}, {}] to [{}, {}, {}] has no room", region.lower.x(),
                              region.lower.y(), region.lower.z(), region.upper.x(), region.upper.y(), region.upper.z()),
                  "give a lower corner below the upper one in x, y and z");
  } else {
    const double least = std::min(region.radius_bottom, region.radius_top);
    if (!region.base.allFinite() || !(least >= 0) || !(region.radius_top > 0) || !std::isfinite(region.radius_bottom) ||
        !std::isfinite(region.radius_top) || !(region.height > 0) || !std::isfinite(region.height))
      throw Error("fill",
                  fmt::format("a frustum of radii {} and {} and height {} has no room", region.radius_bottom,
                              region.radius_top, region.height),
                  "give a positive radius_top and height, and a radius_bottom of zero or more");
  }
  const double extent = region.kind == FillRegion::Kind::box
                            ? (region.upper - region.lower).maxCoeff()
                            : std::max({region.radius_bottom, region.radius_top, region.height});
  for (double r : radii)
    if (!(r > 1e-12 * extent) || !std::isfinite(r))
      throw Error("fill", fmt::format("a grain has an enclosing radius of {:g} m in a region of {:g} m", r, extent),
                  "give positive, finite sizes that are not lost in the region");
}

[[noreturn]] void no_room(std::size_t placed, std::size_t count, double balls, const Room& room) {
  const double wanted = room.height_for(balls / aimed_fraction);
  throw Error(
      "fill",
      fmt::format("only {} of {} grains fit: the balls that enclose them take {:.0f} % of the region, and random "
                  "places without overlap can be found up to about 30 %",
                  placed, count, 100 * balls / room.volume()),
      wanted > room.height()
          ? fmt::format("make the region {:.3g} m higher ({:.3g} m in all), allow it to grow, or use fewer grains",
                        wanted - room.height(), wanted)
          : "make the region wider against the grains, allow it to grow, or use fewer grains");
}

}  // namespace

std::vector<Placement> place_balls(const FillRegion& region, std::span<const double> radii, std::uint64_t seed,
                                   const PeriodicCell& cell) {
  validate(region, radii);
  keep_within(cell, region);
  std::vector<Placement> result(radii.size());
  if (radii.empty()) return result;

  std::vector<std::size_t> order(radii.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return radii[a] > radii[b]; });
  const double largest = radii[order[0]];

  Room room(region, cell);
  if (room.widest(region.grow) < largest)
    throw Error("fill",
                fmt::format("a grain of {:.3g} m across does not fit into the region, which can hold {:.3g} m",
                            2 * largest, 2 * room.widest(region.grow)),
                "make the region wider, or the grains smaller");
  double balls = 0;
  for (double r : radii) balls += 4 * std::numbers::pi / 3 * r * r * r;
  if (region.grow) {
    room.set_height(std::max(room.height_for(balls / aimed_fraction), 2.5 * largest));
  } else if (balls > 0.6 * room.volume()) {
    no_room(0, radii.size(), balls, room);
  }

  Random places(seed, 1), turns(seed, 2);
  BallGrid grid(largest, radii.size());
  std::size_t tries_left = region.grow ? 0 : mean_tries * radii.size() + tries_before_giving_up;
  const Vec3 corner = region.kind == FillRegion::Kind::box ? region.lower : region.base;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const double r = radii[order[k]];
    Vec3 centre;
    const auto free = [&](const Vec3& image) { return grid.free(image - corner, r); };
    for (int tries = 1;; ++tries) {
      if (room.propose(r, places, centre) && cell.each_image(centre, r + largest, free)) break;
      if (region.grow && tries % tries_before_growth == 0) room.set_height(growth * room.height() + r);
      if (!region.grow && (tries >= tries_before_giving_up || --tries_left == 0)) no_room(k, order.size(), balls, room);
    }
    grid.add(centre - corner, r);
    result[order[k]].position = cell.wrapped(centre);
  }
  for (Placement& placement : result) placement.orientation = turns.rotation();
  return result;
}

}  // namespace repose
