#include "core/grain_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/mass_properties.hpp"

namespace repose {
namespace {

void require(bool holds, std::string_view shape, const std::string& problem, const std::string& remedy) {
  if (!holds) throw Error(fmt::format("grain shape '{}'", shape), problem, remedy);
}

Part at(Primitive primitive, double x) { return {std::move(primitive), {Vec3(x, 0, 0), Quat::Identity()}}; }

void require_ellipsoid(std::string_view shape, const char* key, const Vec3& a) {
  require(a.allFinite() && a.minCoeff() > 0, shape, fmt::format("{} is [{}, {}, {}]", key, a.x(), a.y(), a.z()),
          "give three positive semi-axes, relative to the radius of the main sphere");
}

std::vector<Part> twin(std::string_view shape, const GrainProportions& p) {
  require(p.twin_distance > 0 && p.twin_distance < 2, shape,
          fmt::format("twin_distance is {}: the two spheres of radius 1 would be one, or part", p.twin_distance),
          "give a distance of the centres between 0 and 2 radii");
  return {at(Sphere{1}, -0.5 * p.twin_distance), at(Sphere{1}, 0.5 * p.twin_distance)};
}

// The parts for a main sphere of radius 1, long axis x.
std::vector<Part> described(std::string_view name, const GrainProportions& p) {
  if (name == "sphere") return {at(Sphere{1}, 0)};
  if (name == "ellipsoid") {
    require(p.ellipsoid_aspect > 0 && std::isfinite(p.ellipsoid_aspect), name,
            fmt::format("ellipsoid_aspect is {}", p.ellipsoid_aspect), "give a positive ratio of the semi-axes");
    return {at(Ellipsoid{{p.ellipsoid_aspect, 1, 1}}, 0)};
  }
  if (name == "twin") return twin(name, p);
  if (name == "uneven_twin") {
    const double r = p.uneven_twin_radius, d = p.uneven_twin_distance;
    require(r > 0 && r <= 1, name, fmt::format("uneven_twin_radius is {}", r), "give a radius between 0 and 1");
    require(d > 1 - r && d < 1 + r, name,
            fmt::format("uneven_twin_distance is {}: the spheres of radius 1 and {} would be one, or part", d, r),
            fmt::format("give a distance of the centres between {} and {}", 1 - r, 1 + r));
    return {at(Sphere{1}, 0), at(Sphere{r}, d)};
  }
  if (name == "sphere_cone") {
    require(p.cone_apex > 1 && std::isfinite(p.cone_apex), name,
            fmt::format("cone_apex is {}: the apex does not stand out of the sphere of radius 1", p.cone_apex),
            "give a distance of the apex from the centre above 1");
    return {at(RoundCone{1, 0, p.cone_apex}, 0)};
  }
  if (name == "sphere_ellipsoid") {
    require_ellipsoid(name, "side_ellipsoid", p.side_ellipsoid);
    return {at(Sphere{1}, 0), at(Ellipsoid{p.side_ellipsoid}, 1)};
  }
  if (name == "pierced_twin") {
    require_ellipsoid(name, "piercing_ellipsoid", p.piercing_ellipsoid);
    std::vector<Part> parts = twin(name, p);
    parts.push_back(at(Ellipsoid{p.piercing_ellipsoid}, 0));
    return parts;
  }
  throw Error("", fmt::format("there is no grain shape '{}'", name),
              fmt::format("use one of: {}", fmt::join(grain_shape_names(), ", ")));
}

}  // namespace

GrainProportions GrainProportions::with_aspect(double factor) const {
  if (!(factor > 0) || !std::isfinite(factor))
    throw Error("aspect", fmt::format("it is {}, but must be positive and finite", factor),
                "use 1 for the default shapes");
  GrainProportions p = *this;
  p.ellipsoid_aspect = 1 + factor * (ellipsoid_aspect - 1);
  p.twin_distance *= factor;
  p.uneven_twin_distance = 1 - uneven_twin_radius + factor * (uneven_twin_distance + uneven_twin_radius - 1);
  p.cone_apex = 1 + factor * (cone_apex - 1);
  p.side_ellipsoid.x() *= factor;
  p.piercing_ellipsoid.x() = 1 + factor * (piercing_ellipsoid.x() - 1);
  return p;
}

const std::vector<std::string>& grain_shape_names() {
  static const std::vector<std::string> names{"sphere",      "ellipsoid",        "twin",        "uneven_twin",
                                              "sphere_cone", "sphere_ellipsoid", "pierced_twin"};
  return names;
}

Shape make_grain_shape(std::string_view name, const GrainProportions& proportions) {
  std::vector<Part> parts = described(name, proportions);
  const double factor = std::cbrt(std::numbers::pi / 6 / union_mass_properties(parts).volume);
  for (Part& part : parts) part = scaled(part, factor);
  return make_shape(std::string(name), std::move(parts));
}

}  // namespace repose
