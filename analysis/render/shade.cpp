#include "analysis/render/shade.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/render/palette.hpp"

namespace repose {
namespace {

constexpr double pi = std::numbers::pi;
/// Half of the sun's opening angle, as a tangent: wide enough for soft shadows.
constexpr double sun_tangent = 0.03;
constexpr double far = 1e9;

struct Direction {
  double u, v;  ///< both in [0, 1)
};

/// The k-th point of the R2 sequence (Roberts 2018), shifted by the pixel's own offset.
Direction low_discrepancy(std::uint32_t noise, int k) {
  const double u = static_cast<double>(noise & 0xffffU) / 65536 + 0.7548776662466927 * (k + 1);
  const double v = static_cast<double>(noise >> 16U) / 65536 + 0.5698402909980532 * (k + 1);
  return {u - std::floor(u), v - std::floor(v)};
}

/// Two unit vectors across `n` (Duff et al. 2017).
std::pair<Vec3, Vec3> tangents(const Vec3& n) {
  const double sign = std::copysign(1.0, n.z()), a = -1 / (sign + n.z()), b = n.x() * n.y() * a;
  return {Vec3(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()), Vec3(b, sign + n.y() * n.y() * a, -n.y())};
}

Vec3 on_hemisphere(const Vec3& normal, const Direction& d) {
  const auto [t1, t2] = tangents(normal);
  const double r = std::sqrt(d.u), angle = 2 * pi * d.v;
  return r * std::cos(angle) * t1 + r * std::sin(angle) * t2 + std::sqrt(std::max(0.0, 1 - d.u)) * normal;
}

struct Incoming {
  double sun = 0;  ///< share of the sun's light that arrives, with the cosine
  double sky = 0;  ///< mean radiance of the sky that arrives
};

double sky_radiance(const Light& light, const Vec3& d) {
  const double up = d.z() > 0 ? 0.62 + 0.5 * d.z() : 0.36;
  return up + 0.22 * std::max(0.0, d.dot(light.fill));
}

Incoming gather(const Stage& stage, const Light& light, const Vec3& point, const Vec3& normal,
                const SampleIndex& index) {
  Incoming in;
  // Larger than the error of a single-precision hit, far smaller than a grain.
  const Vec3 start = point + (2e-3 + 2e-6 * point.cwiseAbs().maxCoeff()) * normal;
  const auto [s1, s2] = tangents(light.sun);
  const Direction disc = low_discrepancy(index.noise ^ 0x9e3779b9U, index.sample);
  const double r = sun_tangent * std::sqrt(disc.u), angle = 2 * pi * disc.v;
  const Vec3 to_sun = (light.sun + r * std::cos(angle) * s1 + r * std::sin(angle) * s2).normalized();
  const double cosine = normal.dot(to_sun);
  if (cosine > 0 && !stage.solid.blocked(start, to_sun, far)) in.sun = cosine;
  if (index.sky_rays == 0) {
    in.sky = sky_radiance(light, normal);
    return in;
  }
  for (int k = 0; k < index.sky_rays; ++k) {
    const Vec3 d = on_hemisphere(normal, low_discrepancy(index.noise, index.sample * index.sky_rays + k));
    // What blocks the sky is lit itself and sends a little of that on.
    in.sky += stage.solid.blocked(start, d, far) ? 0.1 : sky_radiance(light, d);
  }
  in.sky /= index.sky_rays;
  return in;
}

Vec3 lit(const Vec3& albedo, const Incoming& in) {
  return albedo.cwiseProduct(in.sun * Vec3(0.80, 0.775, 0.73) + in.sky * Vec3(0.50, 0.52, 0.55));
}

double luminance(const Incoming& in) { return in.sun * 0.775 + in.sky * 0.52; }

}  // namespace

Light light_for(const CameraAxes& axes) {
  Vec3 ahead = Vec3::UnitZ().cross(axes.right);
  if (ahead.norm() < 1e-6) ahead = axes.up;
  ahead.normalize();
  const Vec3 sideways = ahead.cross(Vec3::UnitZ());
  Light light;
  light.sun = (-0.62 * sideways + 0.95 * Vec3::UnitZ() - 0.42 * ahead).normalized();
  light.fill = (0.5 * sideways - 0.8 * ahead + 0.25 * Vec3::UnitZ()).normalized();
  constexpr int points = 1024;
  double sum = 0;
  for (int k = 0; k < points; ++k) sum += sky_radiance(light, on_hemisphere(Vec3::UnitZ(), low_discrepancy(0, k)));
  light.open_sky = sum / points;
  return light;
}

std::uint32_t pixel_noise(std::uint32_t x, std::uint32_t y) {
  std::uint32_t h = x * 0x8da6b343U ^ y * 0xd8163841U;
  h ^= h >> 16U;
  h *= 0x7feb352dU;
  h ^= h >> 15U;
  h *= 0x846ca68bU;
  return h ^ (h >> 16U);
}

Radiance trace(const Stage& stage, const Light& light, const Vec3& origin, const Vec3& direction, double ground_fade,
               const SampleIndex& index) {
  Radiance result;
  RayHit hit;
  double reach = far;
  Vec3 behind = Vec3::Zero();
  double behind_cover = 0;
  if (stage.solid.nearest(origin, direction, far, hit)) {
    if (hit.normal.dot(direction) > 0) hit.normal = -hit.normal;
    reach = hit.distance;
    behind_cover = 1;
  }
  double ground_at = far;
  if (stage.ground && direction.z() < 0) ground_at = (*stage.ground - origin.z()) / direction.z();
  if (ground_at > 0 && ground_at < reach) {
    reach = ground_at;
    behind_cover = 0;
    if (ground_fade > 0) {
      const Vec3 point = origin + ground_at * direction;
      const Incoming in = gather(stage, light, point, Vec3::UnitZ(), index);
      result.backdrop_shade = 1 - ground_fade * (1 - luminance(in) / luminance({light.sun.z(), light.open_sky}));
    }
  } else if (behind_cover > 0) {
    const Vec3 point = origin + reach * direction;
    behind = lit(stage.colour[static_cast<std::size_t>(hit.owner)], gather(stage, light, point, hit.normal, index));
  }
  if (stage.glass.empty()) {
    result.colour = behind;
    result.cover = behind_cover;
    return result;
  }
  // Glass, front to back: clear where it is seen squarely, more solid towards its outline.
  double open = 1;
  double from = 0;
  for (int layer = 0; layer < 8; ++layer) {
    RayHit pane;
    const Vec3 start = origin + from * direction;
    if (!stage.glass.nearest(start, direction, reach - from, pane)) break;
    const double facing = std::abs(pane.normal.dot(direction)) / direction.norm();
    const double cover = 0.05 + 0.5 * std::pow(1 - facing, 3);
    const double gloss = std::max(0.0, pane.normal.dot(light.sun));
    result.colour += open * cover * (0.55 + 0.4 * gloss) * Vec3(0.80, 0.86, 0.92);
    open *= 1 - cover;
    from += pane.distance + 1e-3;
  }
  result.colour += open * behind;
  result.cover = 1 - open * (1 - behind_cover);
  return result;
}

Vec3 tone_mapped(const Vec3& linear) {
  constexpr double knee = 0.75;
  Vec3 screen;
  for (int i = 0; i < 3; ++i) {
    const double v = std::max(0.0, linear[i]);
    screen[i] = v <= knee ? v : knee + (1 - knee) * (1 - std::exp(-(v - knee) / (1 - knee)));
  }
  return screen;
}

}  // namespace repose
