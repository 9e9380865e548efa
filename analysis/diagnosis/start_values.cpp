#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Dense>

#include "analysis/diagnosis/problem.hpp"
#include "analysis/diagnosis/turning.hpp"
#include "core/scene_yaml.hpp"
#include "core/yaml_tree.hpp"

namespace repose::diagnosis {
namespace {

constexpr int early_samples = 10;
// Of the weak prior: so many standard errors of the noise, or, for an impact bends the path that is read as a parabola, this share of the fastest
// that was seen.
constexpr double prior_errors = 30, prior_share = 0.3;

/// Value and slope at time 0 of a parabola through the first samples; their standard errors for unit noise.
struct Early {
  bool seen = false;
  double value = 0, slope = 0, value_se = 1, slope_se = 1;
};

Early early(const std::vector<double>& time, const std::vector<double>& value) {
  std::vector<double> t, x;
  for (std::size_t i = 0; i < time.size() && t.size() < early_samples; ++i)
    if (std::isfinite(value[i]) && time[i] >= 0) {
      t.push_back(time[i]);
      x.push_back(value[i]);
    }
  if (t.size() < 2) return {};
  const Eigen::Index n = static_cast<Eigen::Index>(t.size()), order = n >= 5 ? 3 : 2;
  Eigen::MatrixXd basis(n, order);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < order; ++k) basis(i, k) = std::pow(t[static_cast<std::size_t>(i)], static_cast<double>(k));
  const Eigen::VectorXd data = Eigen::Map<const Eigen::VectorXd>(x.data(), n);
  const Eigen::VectorXd fit = basis.colPivHouseholderQr().solve(data);
  const Eigen::MatrixXd covariance = (basis.transpose() * basis).inverse();
  return {true, fit[0], fit[1], std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1))};
}

struct Seen {
  Early position[3], turn[3];
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

Seen look_at(const Observation& o) {
  Seen seen;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> x;
    for (const Vec3& p : o.position) x.push_back(p[k]);
    seen.position[k] = early(o.time, x);
    seen.speed = std::max(seen.speed, fastest(o.time, x));
  }
  const auto first = std::find_if(o.orientation.begin(), o.orientation.end(), [](const Quat& q) { return std::isfinite(q.w()); });
  if (first == o.orientation.end()) return seen;
  const auto turns = turns_of(o.orientation);
  Vec3 at_zero = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    seen.turn[k] = early(o.time, turns[static_cast<std::size_t>(k)]);
    at_zero[k] = seen.turn[k].value;
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
    const Seen seen = observed != nullptr ? look_at(*observed) : Seen{};
    const auto add = [&](const std::string& what, Parameter::Use use, int k, double start, double uncertainty, double fastest_seen = 0) {
      Parameter p;
      p.use = use;
      p.key = "bodies." + body.name + "." + what;
      p.component = k;
      p.start = p.null = p.read = start;
      p.step = 0.5 * uncertainty;
      p.told = what == "position" ? body.position[k] : what == "velocity" ? body.velocity[k] : what == "angular_velocity" ? body.angular_velocity[k] : start;
      if (observed != nullptr) p.prior_sd = std::max(prior_errors * uncertainty, prior_share * fastest_seen);
      result.push_back(p);
    };
    for (const std::string& key : run.free) {
      const auto [vector, component] = vector_key(key);
      const auto is = [&, &vector = vector](const char* what) { return vector == "bodies." + body.name + "." + what; };
      for (int k = 0; k < 3; ++k) {
        if (component >= 0 && component != k) continue;
        const Early& x = seen.position[k];
        const Early& turn = seen.turn[k];
        if (is("position") && x.seen) add("position", Parameter::Use::scene, k, x.value, sd("position") * x.value_se);
        if (is("velocity") && x.seen) add("velocity", Parameter::Use::scene, k, x.slope, sd("position") * x.slope_se, seen.speed);
        if (is("orientation") && seen.orientation) add("orientation", Parameter::Use::turn, k, 0, sd("orientation") * turn.value_se);
        if (is("angular_velocity") && seen.orientation)
          add("angular_velocity", Parameter::Use::scene, k, turn.slope, sd("orientation") * turn.slope_se, seen.spin);
        // Seen through a series only: from where the scene starts.
        if (is("position") && observed == nullptr) add("position", Parameter::Use::scene, k, body.position[k], 1e-3);
        if (is("velocity") && observed == nullptr) add("velocity", Parameter::Use::scene, k, body.velocity[k], 0.02);
      }
    }
  }
  for (const std::string& key : run.free) {
    if (vector_key(key).second >= 0) continue;
    if (const std::optional<Parameter> p = number_of(tree, key)) result.push_back(*p);
  }
  return result;
}

}  // namespace repose::diagnosis
