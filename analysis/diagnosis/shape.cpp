#include "analysis/diagnosis/shape.hpp"

#include <algorithm>
#include <cmath>

namespace repose::diagnosis {
namespace {

struct Point {
  std::size_t group = 0;
  double y = 0, weight = 0;
  const Segment* segment = nullptr;
};

double value_of(const Segment& s, const std::string& variable) {
  if (variable == "speed") return s.speed;
  if (variable == "slip_speed") return s.slip_speed;
  if (variable == "normal_force") return s.normal_force;
  if (variable == "spin") return s.spin;
  if (variable == "height") return s.height;
  return s.time;
}

/// y = c x^power through the origin: share of the left-out sum of squares that it explains.
double explained_by(const std::vector<Point>& points, const std::string& variable, int power) {
  double left = 0, total = 0;
  for (const Point& out : points) {
    double xy = 0, xx = 0;
    for (const Point& p : points) {
      if (p.group == out.group) continue;
      const double x = std::pow(value_of(*p.segment, variable), power);
      xy += p.weight * x * p.y;
      xx += p.weight * x * x;
    }
    const double prediction = xx > 0 ? xy / xx * std::pow(value_of(*out.segment, variable), power) : 0;
    left += out.weight * (out.y - prediction) * (out.y - prediction);
    total += out.weight * out.y * out.y;
  }
  return total > 0 ? std::clamp(1 - left / total, 0.0, 1.0) : 0;
}

}  // namespace

std::vector<Dependence> dependence_of(const std::vector<Located>& located) {
  std::vector<Point> points;
  bool several = false;
  for (const Located& l : located) several = several || l.run != located.front().run;
  for (std::size_t i = 0; i < located.size(); ++i) {
    const Located& l = located[i];
    const double speed = l.segment.velocity.norm(), se = l.force_se.norm();
    if (!(se > 0) || !std::isfinite(se)) continue;
    const Vec3 along = speed > 0 ? Vec3(l.segment.velocity / speed) : Vec3::UnitZ();
    points.push_back({several ? l.run : i, -l.force.dot(along), 1 / (se * se), &l.segment});
  }
  if (points.size() < 4) return {};
  std::vector<Dependence> result;
  for (const char* variable : {"speed", "slip_speed", "normal_force", "spin", "height", "time"}) {
    const double linear = explained_by(points, variable, 1), quadratic = explained_by(points, variable, 2);
    result.push_back(quadratic > linear + 0.02 ? Dependence{variable, quadratic, "quadratic"} : Dependence{variable, linear, "linear"});
  }
  std::stable_sort(result.begin(), result.end(), [](const Dependence& a, const Dependence& b) { return a.explained > b.explained; });
  return result;
}

}  // namespace repose::diagnosis
