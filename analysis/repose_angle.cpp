#include "analysis/repose_angle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "analysis/silhouette.hpp"
#include "analysis/statistics.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double nothing = -std::numeric_limits<double>::infinity();

double slope_angle(double slope) { return std::atan(-slope) / degree; }

void require(const ReposeOptions& o) {
  if (o.azimuths < 1 || !(o.from >= 0 && o.to > o.from && o.to <= 1) || !(o.half_depth > 0) || !(o.columns_per_diameter > 0))
    throw Error("angle of repose", "the options are out of range",
                "use azimuths >= 1, 0 <= from < to <= 1, half_depth > 0, columns_per_diameter > 0");
}

Vec2 direction(double azimuth_deg) { return {std::cos(azimuth_deg * degree), std::sin(azimuth_deg * degree)}; }

// The highest point per column of the picture, as grains are drawn into it one by one.
class Picture {
 public:
  Picture(double left, double right, double pixel)
      : left_(left), pixel_(pixel), top_(static_cast<std::size_t>(std::max(1.0, (right - left) / pixel)), nothing) {}

  // `view`: the part on the screen; `origin`: the screen coordinate of the axis in that view.
  void draw(const SideView& view, double origin) {
    const double start = origin + left_;
    const double first = std::max(0.0, std::ceil((view.left() - start) / pixel_ - 0.5));
    const double last = std::min(static_cast<double>(top_.size()) - 1, std::floor((view.right() - start) / pixel_ - 0.5));
    for (double i = first; i <= last; ++i) {
      double& top = top_[static_cast<std::size_t>(i)];
      top = std::max(top, view.top(start + (i + 0.5) * pixel_));
    }
  }

  Outline outline(double plate) const {
    Outline result;
    for (std::size_t i = 0; i < top_.size(); ++i) {
      if (top_[i] == nothing) continue;
      result.s.push_back(left_ + (static_cast<double>(i) + 0.5) * pixel_);
      result.z.push_back(top_[i] - plate);
    }
    return result;
  }

 private:
  double left_, pixel_;
  std::vector<double> top_;
};

Outline flank_of(const std::vector<GrainPart>& parts, const Snapshot& state, const HeapSite& site, double azimuth_deg,
                 double half_depth, double pixel) {
  const Vec2 down = direction(azimuth_deg), axis = site.centre.head<2>();
  Picture picture(0, site.radius, pixel);
  for (const GrainPart& part : parts) {
    const Vec2 centre = state.position[static_cast<std::size_t>(part.body)].head<2>() - axis;
    const double r = centre.norm();
    if (!(r > 0) || r * std::acos(std::clamp(centre.dot(down) / r, -1.0, 1.0)) > half_depth) continue;
    const Vec2 across = centre / r;
    picture.draw(SideView(part, across), across.dot(axis));
  }
  return picture.outline(site.centre.z());
}

Outline whole_outline(const std::vector<GrainPart>& parts, const HeapSite& site, double azimuth_deg, double pixel) {
  const Vec2 across = direction(azimuth_deg);
  Picture picture(-site.radius, site.radius, pixel);
  for (const GrainPart& part : parts) picture.draw(SideView(part, across), across.dot(site.centre.head<2>()));
  return picture.outline(site.centre.z());
}

// The line through the outline where side * s lies in [from, to]; distances from the axis are positive.
std::optional<Line> fit_stretch(const Outline& outline, double side, double from, double to) {
  std::vector<double> x, z;
  for (std::size_t i = 0; i < outline.s.size(); ++i) {
    const double s = side * outline.s[i];
    if (s < from || s > to) continue;
    x.push_back(s);
    z.push_back(outline.z[i]);
  }
  if (x.size() < 3) return std::nullopt;
  return fit_line(x, z);
}

struct Flanks {
  std::vector<Flank> list;
  double apex = 0;

  void add(const Outline& outline, double side, double azimuth, double from, double to, double diameter) {
    const double half = 0.5 * (from + to);
    const auto line = fit_stretch(outline, side, from, to);
    const auto upper = fit_stretch(outline, side, from, half), lower = fit_stretch(outline, side, half, to);
    if (!line || !upper || !lower) return;
    apex += line->intercept;
    list.push_back({azimuth, slope_angle(line->slope), slope_angle(upper->slope), slope_angle(lower->slope), line->rms / diameter});
  }
};

template <class Get>
Summary over(const std::vector<Flank>& flanks, Get get) {
  std::vector<double> values;
  for (const Flank& f : flanks) values.push_back(get(f));
  return summarise(values);
}

// Neighbouring views share grains, so single flanks are not independent; sectors of 60 degrees nearly are.
double sector_error(const std::vector<Flank>& flanks) {
  std::array<std::vector<double>, 6> sectors;
  for (const Flank& f : flanks)
    sectors[std::min<std::size_t>(5, static_cast<std::size_t>(f.azimuth_deg / 60))].push_back(f.angle_deg);
  std::vector<double> means;
  for (const auto& s : sectors)
    if (!s.empty()) means.push_back(summarise(s).mean);
  return summarise(means).se;
}

std::string why_not(const HeapGrains& grains, const RadialProfile& profile, const ReposeOptions& options) {
  if (grains.heap.size() < 100)
    return "only " + std::to_string(grains.heap.size()) + " grains lie on the base: at least 100 make a heap";
  if (profile.foot * (options.to - options.from) < 4 * grains.diameter)
    return "the flanks are shorter than four grain diameters: pour more grains";
  if (profile.height.front() < 2 * grains.diameter) return "the heap is flat: it is lower than two grain diameters";
  return {};
}

}  // namespace

Outline flank_outline(const Model& model, const Snapshot& state, const HeapGrains& grains, const HeapSite& site,
                      double azimuth_deg, const ReposeOptions& options) {
  require(options);
  if (grains.heap.empty()) return {};
  return flank_of(grain_parts(model, state, grains.heap), state, site, azimuth_deg, options.half_depth * grains.diameter,
                  grains.diameter / options.columns_per_diameter);
}

Outline heap_outline(const Model& model, const Snapshot& state, const HeapGrains& grains, const HeapSite& site,
                     double azimuth_deg, const ReposeOptions& options) {
  require(options);
  if (grains.heap.empty()) return {};
  return whole_outline(grain_parts(model, state, grains.heap), site, azimuth_deg, grains.diameter / options.columns_per_diameter);
}

ReposeMeasurement measure_repose_angle(const Model& model, const Snapshot& state, const HeapSite& site,
                                       const ReposeOptions& options) {
  require(options);
  ReposeMeasurement result;
  result.grains = find_heap(model, state, site);
  if (result.grains.heap.empty()) {
    result.message = "no grain lies on the base";
    return result;
  }
  const double diameter = result.grains.diameter;
  result.profile = radial_profile(height_map(model, state, result.grains, site, options.columns_per_diameter), site, diameter);
  result.message = why_not(result.grains, result.profile, options);
  if (!result.message.empty()) return result;

  const std::vector<GrainPart> parts = grain_parts(model, state, result.grains.heap);
  const double foot = result.profile.foot;
  const double from = options.from * foot, to = options.to * foot, pixel = diameter / options.columns_per_diameter;
  Flanks flanks, whole;
  for (int k = 0; k < 2 * options.azimuths; ++k) {
    const double azimuth = 180.0 * k / options.azimuths;
    flanks.add(flank_of(parts, state, site, azimuth, options.half_depth * diameter, pixel), 1, azimuth, from, to, diameter);
  }
  for (int k = 0; k < options.azimuths; ++k) {
    const double azimuth = 180.0 * k / options.azimuths;
    const Outline outline = whole_outline(parts, site, azimuth, pixel);
    whole.add(outline, 1, azimuth, from, to, diameter);
    whole.add(outline, -1, azimuth + 180, from, to, diameter);
  }
  if (flanks.list.empty()) {
    result.message = "no view shows a flank";
    return result;
  }
  ReposeAngle angle;
  const Summary all = over(flanks.list, [](const Flank& f) { return f.angle_deg; });
  angle.value = all.mean;
  angle.sd = all.sd;
  angle.se = sector_error(flanks.list);
  angle.rms = over(flanks.list, [](const Flank& f) { return f.rms; }).mean;
  angle.concavity = over(flanks.list, [](const Flank& f) { return f.upper_deg - f.lower_deg; }).mean;
  angle.foot = foot;
  angle.apex = flanks.apex / static_cast<double>(flanks.list.size());
  angle.whole_depth = over(whole.list, [](const Flank& f) { return f.angle_deg; }).mean;

  std::vector<double> r, z;
  for (std::size_t i = 0; i < result.profile.radius.size(); ++i) {
    if (result.profile.radius[i] < from || result.profile.radius[i] > to) continue;
    r.push_back(result.profile.radius[i]);
    z.push_back(result.profile.height[i]);
  }
  if (r.size() >= 3) {
    const Line line = fit_line(r, z);
    angle.radial = slope_angle(line.slope);
    angle.radial_se = line.slope_se / (1 + line.slope * line.slope) / degree;
  }
  angle.flanks = std::move(flanks.list);
  result.angle = std::move(angle);
  return result;
}

}  // namespace repose
