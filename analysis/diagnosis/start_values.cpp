#include "analysis/diagnosis/start_values.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Dense>

#include "analysis/diagnosis/turning.hpp"
#include "core/scene_yaml.hpp"
#include "core/yaml_tree.hpp"

namespace repose::diagnosis {
namespace {

constexpr int early_samples = 10, fewest_to_judge = 8;
// Of the weak prior: so many standard errors of the noise, or this share of the fastest that was seen, for an impact bends the path that is read as a
// parabola, and a ball that slides for a moment before it rolls has begun with another velocity than the path shows.
constexpr double prior_errors = 30, prior_share = 0.3;
// Along an axis on which a body does not move all the while it begins with no more than this share of its fastest (a frame may be tilted): a hop of a ball
// that rolls, or a push of it into the floor, would be more.
constexpr double still = 0.1, still_prior = 0.03;
constexpr double contradicts = 0.5;    // of the larger of two vectors
constexpr double beyond_noise = 3;     // standard deviations of chi^2: more is no parabola
constexpr double steps_of_spin = 1e-3; // differencing step of a spin that nothing recorded shows directly

/// Value and slope at time 0 of a parabola through the first samples; their standard errors for unit noise.
struct Early {
  bool seen = false, smooth = false;  ///< smooth: a parabola to within the noise
  double value = 0, slope = 0, value_se = 1, slope_se = 1;
  double moves = 0;                   ///< from the first of the samples to the last, at most
};

Early parabola(const std::vector<double>& time, const std::vector<double>& value, std::size_t samples, double noise) {
  const auto n = static_cast<Eigen::Index>(samples), order = static_cast<Eigen::Index>(samples >= 5 ? 3 : 2);
  Eigen::MatrixXd basis(n, order);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < order; ++k) basis(i, k) = std::pow(time[static_cast<std::size_t>(i)], static_cast<double>(k));
  const Eigen::VectorXd data = Eigen::Map<const Eigen::VectorXd>(value.data(), n);
  const Eigen::VectorXd fit = basis.colPivHouseholderQr().solve(data), path = basis * fit;
  const Eigen::MatrixXd covariance = (basis.transpose() * basis).inverse();
  const double free = static_cast<double>(n - order);
  const bool smooth = samples >= fewest_to_judge && (data - path).squaredNorm() <= noise * noise * (free + beyond_noise * std::sqrt(2 * free));
  return {true, smooth, fit[0], fit[1], std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), path.maxCoeff() - path.minCoeff()};
}

/// Of one axis: by the first few samples, and by all.
struct Axis {
  Early early, all;
  double lasts = 0;  ///< [s]

  /// Nothing moves along it, all the while, by more than a small share of what the fastest would.
  bool is_still(double fastest) const { return all.smooth && all.moves < still * fastest * lasts; }
};

/// `noise`: of a value.
Axis look_along(const std::vector<double>& time, const std::vector<double>& value, double noise) {
  std::vector<double> t, x;
  for (std::size_t i = 0; i < time.size(); ++i)
    if (std::isfinite(value[i]) && time[i] >= 0) {
      t.push_back(time[i]);
      x.push_back(value[i]);
    }
  if (t.size() < 2) return {};
  return {parabola(t, x, std::min<std::size_t>(t.size(), early_samples), noise), parabola(t, x, t.size(), noise), t.back() - t.front()};
}

struct Seen {
  Axis position[3], turn[3];
  std::optional<Quat> orientation;
  double speed = 0, spin = 0;  ///< the fastest from one sample to the next
};

double fastest(const std::vector<double>& time, const std::vector<double>& value) {
  double rate = 0;
  std::optional<std::size_t> before;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(value[i])) continue;
    if (before && time[i] > time[*before]) rate = std::max(rate, std::abs(value[i] - value[*before]) / (time[i] - time[*before]));
    before = i;
  }
  return rate;
}

Seen look_at(const Observation& o, double noise_of_position, double noise_of_turn) {
  Seen seen;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> x;
    for (const Vec3& p : o.position) x.push_back(p[k]);
    seen.position[k] = look_along(o.time, x, noise_of_position);
    seen.speed = std::max(seen.speed, fastest(o.time, x));
  }
  const auto first = std::find_if(o.orientation.begin(), o.orientation.end(), [](const Quat& q) { return std::isfinite(q.w()); });
  if (first == o.orientation.end()) return seen;
  const auto turns = turns_of(o.orientation);
  Vec3 at_zero = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    seen.turn[k] = look_along(o.time, turns[static_cast<std::size_t>(k)], noise_of_turn);
    at_zero[k] = seen.turn[k].early.value;
    seen.spin = std::max(seen.spin, fastest(o.time, turns[static_cast<std::size_t>(k)]));
  }
  seen.orientation = rotation_of(at_zero) * *first;
  return seen;
}

/// The key of a vector without the component that may stand behind it, and that component (-1: all).
std::pair<std::string, int> vector_key(const std::string& key) {
  if (key.size() > 2 && key[key.size() - 2] == '.' && key.back() >= '0' && key.back() <= '2')
    return {key.substr(0, key.size() - 2), key.back() - '0'};
  return {key, -1};
}

/// A positive number of the scene, such as a mass: searched in its logarithm, a hundred times up and down.
std::optional<Parameter> number_of(const YamlNode& tree, const std::string& key) {
  const YamlNode* node = node_at(tree, key);
  if (node == nullptr || node->kind != YamlNode::Kind::scalar) return {};
  const double value = parse_quantity(node->text, dimension::none);
  if (!(value > 0)) return {};
  Parameter p;
  p.key = key;
  p.start = p.null = p.read = value;
  p.lower = value / 100;
  p.upper = value * 100;
  p.step = 1e-3 * value;
  p.logarithmic = true;
  return p;
}

}  // namespace

std::vector<Parameter> start_values(const BundleRun& run, const YamlNode& tree, const std::map<std::string, double>& noise) {
  std::vector<Parameter> result;
  const Scene scene = parse_scene(emit_yaml(tree), "scene");
  const auto sd = [&](const char* name) {
    const auto found = noise.find(name);
    return found == noise.end() || found->second == 0 ? 1e-4 : found->second;
  };
  for (const SceneBody& body : scene.bodies) {
    const Observation* observed = nullptr;
    for (const Observation& o : run.observations)
      if (o.kind == ObservableKind::trajectory && o.body == body.name) observed = &o;
    const double length = sd("position"), angle = sd("orientation");
    const Seen seen = observed != nullptr ? look_at(*observed, length, angle) : Seen{};
    const auto add = [&](const std::string& what, Parameter::Use use, int k, double start, double uncertainty, double prior_sd) {
      Parameter p;
      p.use = use;
      p.key = "bodies." + body.name + "." + what;
      p.component = k;
      p.start = p.null = p.read = start;
      p.step = 0.5 * uncertainty;
      p.told = what == "position" ? body.position[k] : what == "velocity" ? body.velocity[k] : what == "angular_velocity" ? body.angular_velocity[k] : start;
      if (observed != nullptr) p.prior_sd = prior_sd;
      result.push_back(p);
    };
    const auto add_slope = [&](const char* what, int k, double unit, const Axis& axis, double fastest_seen) {
      const bool moves = !axis.is_still(fastest_seen);
      const Early& e = moves ? axis.early : axis.all;
      const double sure = prior_errors * unit * e.slope_se;
      add(what, Parameter::Use::scene, k, e.slope, unit * axis.early.slope_se, std::max(sure, (moves ? prior_share : still_prior) * fastest_seen));
      if (moves) return;
      result.back().lower = e.slope - std::max(sure, still * fastest_seen);
      result.back().upper = e.slope + std::max(sure, still * fastest_seen);
    };
    for (const std::string& key : run.free) {
      const auto [vector, component] = vector_key(key);
      const auto is = [&, &vector = vector](const char* what) { return vector == "bodies." + body.name + "." + what; };
      for (int k = 0; k < 3; ++k) {
        if (component >= 0 && component != k) continue;
        const Early& x = seen.position[k].early;
        const Early& turn = seen.turn[k].early;
        if (is("position") && x.seen) add("position", Parameter::Use::scene, k, x.value, length * x.value_se, prior_errors * length * x.value_se);
        if (is("velocity") && x.seen) add_slope("velocity", k, length, seen.position[k], seen.speed);
        if (is("orientation") && seen.orientation) add("orientation", Parameter::Use::turn, k, 0, angle * turn.value_se, prior_errors * angle * turn.value_se);
        if (is("angular_velocity") && seen.orientation) add_slope("angular_velocity", k, angle, seen.turn[k], seen.spin);
        // Seen by what it does to the path: as large as makes the body roll, or as the scene has it.
        if (is("angular_velocity") && observed != nullptr && !seen.orientation && path_shows_spin(scene)) {
          const double scale = std::max(body.angular_velocity.norm(), seen.speed / scene.shapes.at(body.shape).bounding_radius);
          if (scale > 0) add("angular_velocity", Parameter::Use::scene, k, body.angular_velocity[k], 2 * steps_of_spin * scale, scale);  // what never moves shows no spin
        }
        // Seen through a series only: from where the scene starts.
        if (is("position") && observed == nullptr) add("position", Parameter::Use::scene, k, body.position[k], 1e-3, 0);
        if (is("velocity") && observed == nullptr) add("velocity", Parameter::Use::scene, k, body.velocity[k], 0.02, 0);
      }
    }
  }
  for (const std::string& key : run.free) {
    if (vector_key(key).second >= 0) continue;
    if (const std::optional<Parameter> p = number_of(tree, key)) result.push_back(*p);
  }
  return result;
}

std::vector<StartContradiction> contradictions(const std::vector<Parameter>& start) {
  std::map<std::string, StartContradiction> found;
  std::map<std::string, double> doubt;  // squares
  for (const Parameter& p : start) {
    if (p.use != Parameter::Use::scene || p.component < 0 || !p.key.ends_with("velocity") || !std::isfinite(p.told) || !std::isfinite(p.read)) continue;
    StartContradiction& c = found.try_emplace(p.key, StartContradiction{p.key, Vec3::Zero(), Vec3::Zero()}).first->second;
    c.read[p.component] = p.read;
    c.told[p.component] = p.told;
    doubt[p.key] += p.prior_sd * p.prior_sd;
  }
  std::vector<StartContradiction> beyond_doubt;
  for (const auto& [key, c] : found) {
    const double apart = (c.read - c.told).norm();
    if (c.told.norm() > 0 && apart > contradicts * std::max(c.told.norm(), c.read.norm()) && apart > std::sqrt(doubt.at(key))) beyond_doubt.push_back(c);
  }
  return beyond_doubt;
}

}  // namespace repose::diagnosis
