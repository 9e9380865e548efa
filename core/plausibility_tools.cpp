#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/overlap.hpp"
#include "core/plausibility_checks.hpp"

namespace repose {
namespace {

constexpr double arching = 4;       // outlets below this many typical grains clog now and then (the largest count, too)
constexpr double narrow_base = 10;  // typical grains across a base
constexpr double flattest_fill = 0.1, widest_fill = 1e6;  // height and width of a region, in typical grains

std::string key_of(const Tool& tool, const std::string& key) { return "tools." + tool.name + "." + key; }

double horizontal_distance(const Vec3& a, const Vec3& b) { return std::hypot(a.x() - b.x(), a.y() - b.y()); }

double inner_radius(const Funnel& f, double height) {
  const double cone = height * std::tan(f.half_angle_deg * std::numbers::pi / 180);
  return std::min(0.5 * f.outlet_diameter + cone, 0.5 * f.top_diameter);
}

double funnel_height(const Funnel& f) {
  const double cone = 0.5 * (f.top_diameter - f.outlet_diameter) / std::tan(f.half_angle_deg * std::numbers::pi / 180);
  return cone + f.wall_height;
}

void check_outlet(const Tool& tool, const Funnel& funnel, const PopulationFigures& g, Findings& findings) {
  const double outlet = funnel.outlet_diameter;
  const std::string found = fmt::format("an outlet of {} for grains of {} (largest {})", length_text(outlet),
                                        length_text(g.typical), length_text(g.largest));
  if (outlet < g.largest)
    findings.refuse(key_of(tool, "outlet_diameter"), found + ": the largest do not pass",
                    fmt::format("make it at least {}", length_text(8 * g.typical)));
  else if (outlet < arching * g.typical || outlet < 3 * g.largest)
    findings.warn(key_of(tool, "outlet_diameter"), found + ": grains will form arches over it",
                  fmt::format("make it at least {}", length_text(std::max(6 * g.typical, 4 * g.largest))));
}

// A region as such: wide enough for a grain, not flat, not as large as a landscape.
void check_fill_size(const PopulationFigures& g, Findings& findings) {
  const FillRegion& fill = g.population->fill;
  const bool is_box = fill.kind == FillRegion::Kind::box;
  const double height = is_box ? fill.upper.z() - fill.lower.z() : fill.height;
  const double width =
      is_box ? (fill.upper - fill.lower).head<2>().minCoeff() : 2 * std::max(fill.radius_bottom, fill.radius_top);
  const double widest = is_box ? (fill.upper - fill.lower).head<2>().maxCoeff() : width;
  const std::string place = "grains." + g.population->name + ".fill";
  const std::string remedy = "check the unit of its lengths";
  const double least = fill.grow ? flattest_fill * g.typical : g.largest;
  if (width < g.largest)
    findings.refuse(place, fmt::format("{} wide, for grains of up to {}", length_text(width), length_text(g.largest)),
                    remedy);
  else if (height < least)
    findings.refuse(place, fmt::format("{} high, for grains of {}", length_text(height), length_text(g.typical)),
                    remedy);
  else if (std::max(widest, height) > widest_fill * g.typical)
    findings.refuse(
        place, fmt::format("{} large, for grains of {}", length_text(std::max(widest, height)), length_text(g.typical)),
        remedy);
}

// The region of a population against the inside of the funnel that it starts in.
void check_fill_in_funnel(const GrainPopulation& g, const Tool& tool, const Funnel& funnel, Findings& findings) {
  const FillRegion& fill = g.fill;
  const std::string place = "grains." + g.name + ".fill";
  const bool is_box = fill.kind == FillRegion::Kind::box;
  const double bottom = (is_box ? fill.lower.z() : fill.base.z()) - tool.position.z();
  const double height = is_box ? fill.upper.z() - fill.lower.z() : fill.height;
  const double slack = 1e-3 * funnel.outlet_diameter;
  if (bottom + height < slack || bottom > funnel_height(funnel)) return;  // beside the funnel: another population
  if (bottom < -slack) {
    findings.refuse(place, fmt::format("begins {} below the outlet of `{}`", length_text(-bottom), tool.name),
                    fmt::format("set its lower end to z = {:.6g} m or above", tool.position.z()));
    return;
  }
  const double from_axis =
      horizontal_distance(is_box ? Vec3(0.5 * (fill.lower + fill.upper)) : fill.base, tool.position);
  for (int i = 0; i <= 20; ++i) {
    const double share = i / 20.0, z = bottom + share * height;
    const double radius = is_box ? 0.5 * std::hypot(fill.upper.x() - fill.lower.x(), fill.upper.y() - fill.lower.y())
                                 : fill.radius_bottom + share * (fill.radius_top - fill.radius_bottom);
    const double room = inner_radius(funnel, std::max(0.0, z));
    if (from_axis + radius <= room + slack) continue;
    findings.refuse(place,
                    fmt::format("reaches {} from the axis at z = {:.4g} m, where funnel `{}` has a radius of {}",
                                length_text(from_axis + radius), z + tool.position.z(), tool.name, length_text(room)),
                    "make the region narrower than the funnel: a `frustum` with the funnel's own radii");
    return;
  }
}

// Tools that are made to stand alone; plates, floors, cups and boxes are often put together from overlapping pieces.
bool stands_alone(const Tool& tool) {
  return std::holds_alternative<Funnel>(tool.kind) || std::holds_alternative<Base>(tool.kind) ||
         std::holds_alternative<Roller>(tool.kind) || std::holds_alternative<Blade>(tool.kind) || std::holds_alternative<Drum>(tool.kind);
}

bool overlap(const std::vector<ToolBody>& a, const std::vector<ToolBody>& b) {
  for (const ToolBody& first : a) {
    for (const ToolBody& second : b) {
      double size = 0;
      for (const ToolBody* piece : {&first, &second})
        if (piece->shape.bounded()) size = std::max(size, piece->shape.bounding_radius);
      if (cut_into(first.shape, first.pose, second.shape, second.pose, 1e-6 * size)) return true;
    }
  }
  return false;
}

/// None of the powder starts above the region: the spreader's gap is then one above the plate.
bool starts_bare(const Scene& scene) {
  const LayerSetup& layer = *scene.layer;
  return std::none_of(scene.grains.begin(), scene.grains.end(), [&](const GrainPopulation& g) {
    const FillRegion& fill = g.fill;
    const bool is_box = fill.kind == FillRegion::Kind::box;
    const Vec2 radius = Vec2::Constant(std::max(fill.radius_bottom, fill.radius_top));
    const Vec2 lower = is_box ? Vec2(fill.lower.head<2>()) : Vec2(fill.base.head<2>() - radius);
    const Vec2 upper = is_box ? Vec2(fill.upper.head<2>()) : Vec2(fill.base.head<2>() + radius);
    return (lower.array() < layer.upper.array()).all() && (upper.array() > layer.lower.array()).all();
  });
}

/// A rigid spreader closer to the plate than the largest grain: that grain has nowhere to go.
void check_gap(const Scene& scene, const Tool& spreader, const std::vector<PopulationFigures>& grains, Findings& findings) {
  const LayerSetup& layer = *scene.layer;
  const bool above_plate = layer.gap_from == LayerSetup::GapFrom::plate || starts_bare(scene);
  if (!above_plate || spreader.yield) return;
  double largest = 0;
  for (const PopulationFigures& g : grains) largest = std::max(largest, g.largest);
  if (layer.gap < largest)
    findings.warn("layer.gap",
                  fmt::format("the spreader passes {} above the plate, over grains of up to {}: they jam under it and overlap, and forces mean nothing then",
                              length_text(layer.gap), length_text(largest)),
                  fmt::format("make it larger than {}, or let the spreader give way (`yield` of tools.{})", length_text(largest), spreader.name));
}

/// A spreader beside which powder of the region stays as it is.
void check_width(const LayerSetup& layer, const Tool& spreader, Findings& findings) {
  const auto* roller = std::get_if<Roller>(&spreader.kind);
  const double half = 0.5 * (roller ? roller->width : std::get<Blade>(spreader.kind).width);
  const double y = spreader.position.y();
  const double slack = 1e-9 * (layer.upper.y() - layer.lower.y());
  if (y - half <= layer.lower.y() + slack && y + half >= layer.upper.y() - slack) return;
  const auto span = [](double from, double to) { return fmt::format("from y = {:.4g} to {:.4g} mm", 1e3 * from, 1e3 * to); };
  findings.warn(key_of(spreader, "width"),
                fmt::format("`{}` reaches {}, but the region that is measured {}", spreader.name, span(y - half, y + half), span(layer.lower.y(), layer.upper.y())),
                "widen it or move it (`position`), or make the region narrower");
}

}  // namespace

void check_funnels(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings) {
  for (const Tool& tool : scene.tools) {
    const Funnel* funnel = std::get_if<Funnel>(&tool.kind);
    if (funnel == nullptr) continue;
    for (const PopulationFigures& g : grains) check_outlet(tool, *funnel, g, findings);
    if (funnel->opens >= scene.duration)
      findings.refuse(
          key_of(tool, "opens"),
          fmt::format("the outlet opens at {:.4g} s, but the run ends at {:.4g} s", funnel->opens, scene.duration),
          "open it earlier, or lengthen `duration`");
    else if (funnel->opens > 0.8 * scene.duration)
      findings.warn(key_of(tool, "opens"), "the outlet opens in the last fifth of the run", "open it earlier");
    for (const Tool& other : scene.tools) {
      const Base* base = std::get_if<Base>(&other.kind);
      if (base == nullptr) continue;
      if (tool.position.z() <= other.position.z())
        findings.refuse(key_of(tool, "position"), fmt::format("the outlet lies below the plate of `{}`", other.name),
                        fmt::format("raise it above z = {:.4g} m", other.position.z()));
      if (horizontal_distance(tool.position, other.position) > 0.5 * base->diameter)
        findings.warn(key_of(tool, "position"), fmt::format("the outlet is not above the plate of `{}`", other.name),
                      "give both the same x and y");
    }
  }
}

void check_bases(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings) {
  for (const Tool& tool : scene.tools) {
    const Base* base = std::get_if<Base>(&tool.kind);
    if (base == nullptr) continue;
    for (const PopulationFigures& g : grains) {
      const std::string found =
          fmt::format("a base of {} for grains of {}", length_text(base->diameter), length_text(g.typical));
      const std::string remedy = fmt::format("make it at least {}", length_text(30 * g.typical));
      if (base->diameter < g.largest)
        findings.refuse(key_of(tool, "diameter"), found, remedy);
      else if (base->diameter < narrow_base * g.typical)
        findings.warn(key_of(tool, "diameter"), found + ": no heap has a slope on it", remedy);
    }
    if (base->trench_width == 0 && !grains.empty())
      findings.note(key_of(tool, "trench_width"), "no trench: grains that fall over the edge fall for ever");
    for (const Tool& other : scene.tools)
      if (const Funnel* funnel = std::get_if<Funnel>(&other.kind); funnel && funnel->outlet_diameter > base->diameter)
        findings.warn(key_of(tool, "diameter"), fmt::format("narrower than the outlet of `{}`", other.name),
                      "widen the base");
  }
}

void check_fills(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings) {
  for (const PopulationFigures& g : grains) check_fill_size(g, findings);
  for (const GrainPopulation& g : scene.grains)
    for (const Tool& tool : scene.tools)
      if (const Funnel* funnel = std::get_if<Funnel>(&tool.kind)) {
        check_fill_in_funnel(g, tool, *funnel, findings);
        if (funnel->opens == 0) findings.note(key_of(tool, "opens"), "0: the outlet is open from the start");
      }
}

void check_support(const Scene& scene, Findings& findings) {
  const bool obstacle = !scene.tools.empty() || std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                                            [](const SceneBody& b) { return b.fixed || b.motion; });
  if (!scene.grains.empty() && !obstacle && scene.gravity.norm() > 0)
    findings.warn("tools", "nothing carries the grains: they fall for ever", "add a base, a container or a floor");
}

void check_tool_overlaps(const Scene& scene, Findings& findings) {
  std::vector<std::vector<ToolBody>> built;
  for (const Tool& tool : scene.tools) built.push_back(build_tool(tool));
  for (std::size_t i = 0; i < built.size(); ++i) {
    for (std::size_t j = i + 1; j < built.size(); ++j) {
      if (!overlap(built[i], built[j])) continue;
      const Tool &a = scene.tools[i], &b = scene.tools[j];
      const std::string found = fmt::format("`{}` and `{}` cut into each other", a.name, b.name);
      if (stands_alone(a) || stands_alone(b))
        findings.refuse("tools." + a.name, found, "move one of them (`position`), or make it smaller");
      else
        findings.warn("tools." + a.name, found, "harmless if they are two walls of one vessel; else move one of them");
    }
  }
}

void check_layer(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings) {
  if (!scene.layer) return;
  const LayerSetup& layer = *scene.layer;
  const auto at = [](double x) { return fmt::format("x = {:.4g} mm", 1e3 * x); };
  if (layer.to < layer.upper.x())
    findings.warn("layer.to", fmt::format("the spreader ends at {}, within the region that is measured", at(layer.to)),
                  fmt::format("go to {} or beyond, or end the region before", at(layer.upper.x())));
  if (layer.from && *layer.from > layer.lower.x())
    findings.warn("layer.from", fmt::format("the spreader starts at {}, within the region that is measured", at(*layer.from)),
                  fmt::format("start at {} or before, or begin the region behind it", at(layer.lower.x())));
  // The bed settles without it.
  const auto spreader = std::find_if(scene.tools.begin(), scene.tools.end(), [&](const Tool& t) { return t.name == layer.spreader; });
  if (spreader == scene.tools.end()) return;
  check_width(layer, *spreader, findings);
  check_gap(scene, *spreader, grains, findings);
}

}  // namespace repose
