#include "analysis/diagnosis/confounding.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include <Eigen/Dense>

#include "core/scene_yaml.hpp"

namespace repose::diagnosis {
namespace {

constexpr double factors[] = {0.5, 2.0, 4.0};

/// Of the experiment, in every run that has something of the kind.
struct Change {
  enum class Of { nothing, speed, spin, height, setting } of = Of::nothing;
  double factor = 1;
  std::string words;
  std::string setting = {};  ///< its scene key
};

std::optional<double> plain_number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

/// A number that the experimenter set, for one run or another; start values are changed by their kind.
bool is_setting(const Override& set) {
  for (const char* other : {"solver.", "effects.", "duration", "frame", "record"})
    if (set.path.starts_with(other)) return false;
  for (const char* start : {".position", ".orientation", ".velocity", ".angular_velocity"})
    if (set.path.find(start) != std::string::npos) return false;
  return plain_number(set.value).value_or(0) != 0;
}

std::vector<Change> changes(const Problem& problem) {
  std::vector<Change> all{{Change::Of::nothing, 1, "the same start, recorded again"}};
  std::set<std::string> settings;
  for (const RunData& run : problem.runs())
    for (const Override& set : run.run->set)
      if (is_setting(set)) settings.insert(set.path);
  for (const double factor : factors) {
    all.push_back({Change::Of::speed, factor, fmt::format("start at {} times the speed", factor)});
    all.push_back({Change::Of::spin, factor, fmt::format("start with {} times the spin", factor)});
    all.push_back({Change::Of::height, factor, fmt::format("start from {} times the height", factor)});
    for (const std::string& key : settings) all.push_back({Change::Of::setting, factor, fmt::format("set {} to {} times its value", key, factor), key});
  }
  return all;
}

std::string ending_of(Change::Of kind) {
  return kind == Change::Of::speed ? ".velocity" : kind == Change::Of::spin ? ".angular_velocity" : ".position";
}

Vec3 start_of_body(const SceneBody& body, Change::Of kind) {
  return kind == Change::Of::speed ? body.velocity : kind == Change::Of::spin ? body.angular_velocity : body.position;
}

/// Values of a run that a change sets: keys of its scene, as numbers that no fit turns.
struct SetValues {
  std::vector<Parameter> parameters;
  std::vector<double> values;
  void set(const std::string& key, int component, double value) {
    Parameter p;
    p.key = key;
    p.component = component;
    parameters.push_back(p);
    values.push_back(value);
  }
};

/// What a change makes of a run that started from the values `own` of `layout`.
SetValues changed(const Problem& problem, const Layout& layout, const Values& own, std::size_t run, const Change& change) {
  SetValues result;
  const RunData& data = problem.runs()[run];
  if (change.of == Change::Of::nothing) return result;
  if (change.of == Change::Of::setting) {
    for (const Override& set : data.run->set)
      if (set.path == change.setting)
        if (const auto value = plain_number(set.value)) result.set(set.path, -1, change.factor * *value);
    return result;
  }
  const bool height = change.of == Change::Of::height;
  const Scene scene = read_scene(data.tree, problem.bundle().scene_file.string(), problem.bundle().scene_file.parent_path());
  for (const SceneBody& body : scene.bodies) {
    if (body.fixed || body.motion) continue;
    const std::string key = "bodies." + body.name + ending_of(change.of);
    Vec3 start = start_of_body(body, change.of);
    bool is_free = false;
    const std::vector<Parameter>& free = layout.per_run[run];
    for (std::size_t i = 0; i < free.size(); ++i) {
      if (free[i].use != Parameter::Use::scene || free[i].key != key || free[i].component < 0) continue;
      start[free[i].component] = own[static_cast<Eigen::Index>(i)];
      is_free = true;
    }
    // What stands where it was put may stand on something: it can be raised, not lowered.
    if (height ? !(start.z() > 0) || (!is_free && change.factor < 1) : start.isZero(0)) continue;
    for (int k = height ? 2 : 0; k < 3; ++k) result.set(key, k, change.factor * start[k]);
  }
  return result;
}

/// The fit with these values in one run.
Fit with(Fit fit, std::size_t run, const SetValues& set) {
  std::vector<Parameter>& parameters = fit.layout.per_run[run];
  Values& own = fit.own[run];
  for (std::size_t i = 0; i < set.parameters.size(); ++i) {
    const Parameter& p = set.parameters[i];
    std::size_t at = 0;
    while (at < parameters.size() && !(parameters[at].use == p.use && parameters[at].key == p.key && parameters[at].component == p.component)) ++at;
    if (at == parameters.size()) {
      parameters.push_back(p);
      own.conservativeResize(own.size() + 1);
    }
    own[static_cast<Eigen::Index>(at)] = set.values[i];
  }
  return fit;
}

double separation(const Problem& problem, const Fit& first, const Fit& second, const Change& change, bool& applies) {
  double lambda = 0;
  for (const std::size_t run : first.runs) {
    const SetValues set = changed(problem, first.layout, first.own[run], run, change);
    applies = applies || !set.parameters.empty();
    const Fit a = with(first, run, set), b = with(second, run, set);
    const Eigen::VectorXd of_a = residual_of(problem, a, run), of_b = residual_of(problem, b, run);
    if (of_a.size() == 0 || of_b.size() == 0) continue;
    Eigen::VectorXd d = of_a - of_b;
    // Only what was free in the recordings would be free again; what the change set stands behind it.
    const Eigen::MatrixXd free = jacobian(problem, a, run).own.leftCols(first.own[run].size());
    if (free.cols() > 0) d -= free * free.colPivHouseholderQr().solve(d);
    lambda += std::min(d.squaredNorm(), 1e6);
  }
  return lambda;
}

}  // namespace

SuggestedRecording recording_that_parts(const Problem& problem, const Fit& first, const Fit& second) {
  SuggestedRecording best;
  best.first = first.layout.hypothesis.label();
  best.second = second.layout.hypothesis.label();
  double largest = -1;
  for (const Change& change : changes(problem)) {
    bool applies = change.of == Change::Of::nothing;
    const double lambda = separation(problem, first, second, change, applies);
    if (!applies || lambda <= largest) continue;
    largest = lambda;
    best.what = change.words;
  }
  best.power = 0.5 * std::erfc((2.58 - std::sqrt(std::max(0.0, largest))) / std::sqrt(2.0));
  return best;
}

}  // namespace repose::diagnosis
