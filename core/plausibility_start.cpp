#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "core/overlap.hpp"
#include "core/plausibility_checks.hpp"

namespace repose {
namespace {

constexpr double allowed_depth = 0.01;      // of the smaller body, before an overlap is worth a word
constexpr std::size_t most_explicit = 400;  // pairs are tried one by one
constexpr double large_mass_ratio = 1e6;

const std::string& name_of(const Model& model, std::size_t body) {
  return model.names[static_cast<std::size_t>(model.bodies[body].name)];
}

const Shape& shape_of(const Model& model, std::size_t body) {
  return model.shapes[static_cast<std::size_t>(model.bodies[body].shape)];
}

Pose pose_of(const Model& model, std::size_t body) {
  return {model.initial.position[body], model.initial.orientation[body]};
}

double reach_of(const Model& model, std::size_t body) {
  return model.bodies[body].scale * shape_of(model, body).bounding_radius;
}

bool holds(const Model& model, std::size_t body, const Vec3& point) {
  return contains(shape_of(model, body), pose_of(model, body).to_local(point));
}

/// In a periodic cell also through an image in the next cell.
bool cut_into_images(const Model& model, std::size_t moving, std::size_t other, double depth) {
  const Pose pose = pose_of(model, moving), fixed = pose_of(model, other);
  constexpr double all = std::numeric_limits<double>::infinity();
  return !model.periodic.each_image(pose.position, all, [&](const Vec3& image) {
    return !cut_into(shape_of(model, moving), {image, pose.orientation}, shape_of(model, other), fixed, depth);
  });
}

// Grains whose centre lies in the solid of a tool or of an explicit body.
void check_buried_grains(const Model& model, Findings& findings) {
  for (std::size_t solid = 0; solid < model.bodies.size(); ++solid) {
    if (model.bodies[solid].role == BodyRole::grain || model.bodies[solid].scale != 1) continue;
    std::size_t buried = 0, grain_name = 0;
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
      if (model.bodies[i].role != BodyRole::grain) continue;
      const Vec3& centre = model.initial.position[i];
      const double reach = reach_of(model, solid);
      const bool free = model.periodic.each_image(centre, reach, [&](const Vec3& image) {
        const bool far = shape_of(model, solid).bounded() && (image - model.initial.position[solid]).norm() > reach;
        return far || !holds(model, solid, image);
      });
      if (free) continue;
      ++buried;
      grain_name = i;
    }
    if (buried > 0)
      findings.refuse(fmt::format("grains.{}.fill", name_of(model, grain_name)),
                      fmt::format("{} grains start inside `{}`", buried, name_of(model, solid)),
                      "move or shrink the region, so that it lies in the free space");
  }
}

void check_overfull_funnels(const Scene& scene, const Model& model, Findings& findings) {
  for (const Tool& tool : scene.tools) {
    const Funnel* funnel = std::get_if<Funnel>(&tool.kind);
    if (funnel == nullptr) continue;
    const double cone = 0.5 * (funnel->top_diameter - funnel->outlet_diameter) /
                        std::tan(funnel->half_angle_deg * std::numbers::pi / 180);
    const double rim = tool.position.z() + cone + funnel->wall_height;
    double top = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
      const Vec3 from_funnel = model.initial.position[i] - tool.position;
      if (model.bodies[i].role == BodyRole::grain &&
          std::hypot(from_funnel.x(), from_funnel.y()) < 0.5 * funnel->top_diameter)
        top = std::max(top, model.initial.position[i].z() + reach_of(model, i));
    }
    if (top > rim)
      findings.warn("tools." + tool.name + ".wall_height",
                    fmt::format("the loose fill stands {} above the funnel's rim", length_text(top - rim)),
                    fmt::format("raise it to {} or more", length_text(1.05 * (funnel->wall_height + top - rim))));
  }
}

std::vector<std::size_t> explicit_and_tools(const Model& model) {
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (model.bodies[i].role != BodyRole::grain) list.push_back(i);
  return list;
}

void check_overlapping_bodies(const Model& model, Findings& findings) {
  const std::vector<std::size_t> list = explicit_and_tools(model);
  if (list.size() > most_explicit) {
    findings.note("bodies", "too many bodies to look for overlaps at the start");
    return;
  }
  for (std::size_t i = 0; i < list.size(); ++i) {
    for (std::size_t j = i + 1; j < list.size(); ++j) {
      const std::size_t a = list[i], b = list[j];
      if (!model.bodies[a].dynamic && !model.bodies[b].dynamic) continue;
      const double size = std::min(reach_of(model, a), reach_of(model, b));
      const bool a_moves = model.bodies[a].dynamic;
      if (!cut_into_images(model, a_moves ? a : b, a_moves ? b : a, allowed_depth * size)) continue;
      findings.warn("bodies." + name_of(model, a) + ".position",
                    fmt::format("`{}` starts inside `{}`", name_of(model, a), name_of(model, b)),
                    "move one of them: the solver will push them apart");
    }
  }
}

void check_masses(const Model& model, Findings& findings) {
  double lightest = std::numeric_limits<double>::infinity(), heaviest = 0;
  for (const Body& body : model.bodies) {
    if (!body.dynamic) continue;
    lightest = std::min(lightest, body.mass);
    heaviest = std::max(heaviest, body.mass);
  }
  if (heaviest > large_mass_ratio * lightest)
    findings.warn("bodies", fmt::format("masses from {:.3g} kg to {:.3g} kg", lightest, heaviest),
                  "the solver needs many iterations where the heavy rests on the light; check the units");
}

}  // namespace

void check_start(const Scene& scene, const Model& model, Findings& findings) {
  check_buried_grains(model, findings);
  check_overfull_funnels(scene, model, findings);
  check_overlapping_bodies(model, findings);
  check_masses(model, findings);
}

}  // namespace repose
