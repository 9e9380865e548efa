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

constexpr std::size_t nobody = ~std::size_t{0};

/// c of y = c x^power, by weighted least squares over all groups but one.
double coefficient_of(const std::vector<Point>& points, const std::string& variable, int power, std::size_t left_out) {
  double xy = 0, xx = 0;
  for (const Point& p : points) {
    if (p.group == left_out) continue;
    const double x = std::pow(variable_of(*p.segment, variable), power);
    xy += p.weight * x * p.y;
    xx += p.weight * x * x;
  }
  return xx > 0 ? xy / xx : 0;
}

/// Share of the left-out sum of squares that y = c x^power explains.
double explained_by(const std::vector<Point>& points, const std::string& variable, int power) {
  double left = 0, total = 0;
  for (const Point& out : points) {
    const double prediction =
        coefficient_of(points, variable, power, out.group) * std::pow(variable_of(*out.segment, variable), power);
    left += out.weight * (out.y - prediction) * (out.y - prediction);
    total += out.weight * out.y * out.y;
  }
  return total > 0 ? std::clamp(1 - left / total, 0.0, 1.0) : 0;
}

}  // namespace

double variable_of(const Segment& s, const std::string& variable) {
  if (variable == "speed") return s.speed;
  if (variable == "slip_speed") return s.slip_speed;
  if (variable == "normal_force") return s.normal_force;
  if (variable == "spin") return s.spin;
  if (variable == "height") return s.height;
  return s.time;
}

ForceAgainstMotion against_motion(const Located& l) {
  const double speed = l.segment.velocity.norm();
  const Vec3 along = speed > 0 ? Vec3(l.segment.velocity / speed) : Vec3::UnitZ();
  return {-l.force.dot(along), l.force_se.norm()};
}

std::vector<Dependence> dependence_of(const std::vector<Located>& located) {
  std::vector<Point> points;
  bool several = false;
  for (const Located& l : located) several = several || l.run != located.front().run;
  for (std::size_t i = 0; i < located.size(); ++i) {
    const Located& l = located[i];
    const ForceAgainstMotion force = against_motion(l);
    if (!(force.se > 0) || !std::isfinite(force.se)) continue;
    points.push_back({several ? l.run : i, force.value, 1 / (force.se * force.se), &l.segment});
  }
  if (points.size() < 4) return {};
  std::vector<Dependence> result;
  for (const char* variable : {"speed", "slip_speed", "normal_force", "spin", "height", "time"}) {
    const double linear = explained_by(points, variable, 1), quadratic = explained_by(points, variable, 2);
    const int power = quadratic > linear + 0.02 ? 2 : 1;
    result.push_back({variable, power == 2 ? quadratic : linear, power == 2 ? "quadratic" : "linear",
                      coefficient_of(points, variable, power, nobody)});
  }
  std::stable_sort(result.begin(), result.end(), [](const Dependence& a, const Dependence& b) { return a.explained > b.explained; });
  return result;
}

}  // namespace repose::diagnosis
