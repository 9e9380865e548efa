#include "tests/bench/concealment/concealed_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numbers>
#include <optional>

#include "analysis/bundle/sensor.hpp"
#include "core/error.hpp"
#include "core/yaml_tree.hpp"
#include "tests/bench/concealment/true_world.hpp"

namespace repose::concealment {
namespace {

constexpr int held_out_runs = 3;
constexpr double start_error = 0.03;      // of a free start value, of its size
constexpr double headline_match = 0.15;   // C1: what is left of the shift
constexpr double partly = 0.6;            // C3: what is left of the shift, at most
constexpr double least_signal = 0.3;      // [sigma] less cannot be called concealed

Vec3 vector_of(const std::string& text) {
  const YamlNode node = parse_yaml(text, "vector");
  return {std::stod(node.items.at(0).text), std::stod(node.items.at(1).text), std::stod(node.items.at(2).text)};
}

/// The scene with keys set.
std::string with(const std::string& scene, const std::vector<Override>& keys) {
  YamlNode tree = parse_yaml(scene, "scene");
  for (const Override& key : keys) set_path(tree, key.path, key.value);
  return emit_yaml(tree);
}

bool sets(const std::vector<Override>& changes, const std::string& key) {
  return std::any_of(changes.begin(), changes.end(), [&](const Override& o) { return o.path == key; });
}

Recorder both(const Recorder& a, const Recorder& b) {
  return {a.length * b.length, a.time * b.time, a.offset + b.offset, a.tilt_x + b.tilt_x, a.tilt_y + b.tilt_y, a.bias + b.bias, a.origin + b.origin};
}

/// One attempt at a case.
class Draft {
 public:
  Draft(const std::string& level, std::uint64_t seed, int attempt)
      : level_(level), random_(seed, static_cast<std::uint64_t>(attempt)), e_(draw_experiment(families()[random_.below(families().size())], random_)) {
    // Not what any diagnosis tries: the maker's own step and tolerance are drawn, too.
    Random solved(seed, 1000 + static_cast<std::uint64_t>(attempt));
    conditions_.step_factor = 0.1 * std::pow(4, solved.uniform());
    conditions_.tolerance_factor = 0.03 * std::pow(10, solved.uniform());
  }

  /// nullopt if this draw does not make such a case.
  std::optional<ConcealedCase> make() {
    nominal_ = e_.constants;
    starts();
    if (level_ == "C4") conditions_.backend = random_.uniform() < 0.5 ? "bullet" : "dart";
    if (level_ == "unknown") {
      if (!outside()) return std::nullopt;
    } else if (level_ == "C3") {
      if (!opposed()) return std::nullopt;
    } else if (level_ != "nominal" && !(level_ == "C4" && random_.uniform() < 0.5)) {
      if (!single()) return std::nullopt;
    }
    std::erase_if(nominal_, [&](const Override& o) { return sets(scene_changes(), o.path); });
    calibrated_ = !e_.knob.empty() && sets(nominal_, e_.knob) && (level_ == "C1" || e_.knob_unmeasured || random_.uniform() < 0.3);
    if (level_ == "C1") {
      if (!calibrated_ || !hide()) return std::nullopt;
    } else if (calibrated_) {
      for (Override& o : nominal_)
        if (o.path == e_.knob) o.value = fmt::format("{}", std::stod(o.value) * random_.uniform(0.8, 1.25));
    }
    return written();
  }

 private:
  /// True starts: what is free is not quite what was planned.
  void starts() {
    for (const PlannedRun& run : e_.runs) {
      std::vector<Override> set = run.set;
      for (Override& o : set) {
        if (std::find(e_.free.begin(), e_.free.end(), o.path) == e_.free.end()) continue;
        Vec3 v = vector_of(o.value);
        const double size = v.norm();
        for (int k = 0; k < 3; ++k)
          if (v[k] != 0) v[k] += start_error * size * normal(random_);
        o.value = fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
      }
      true_sets_.push_back(std::move(set));
    }
  }

  std::vector<Override> scene_changes() const {
    std::vector<Override> all;
    for (const Change& c : changes_) all.insert(all.end(), c.scene.begin(), c.scene.end());
    return all;
  }
  Recorder recorder() const {
    Recorder all;
    for (const Change& c : changes_) all = both(all, c.recorder);
    return all;
  }

  History history(const std::vector<Override>& constants, const std::vector<Override>& changes, std::size_t run, const Conditions& conditions) const {
    std::vector<Override> all = constants;
    all.insert(all.end(), changes.begin(), changes.end());
    all.insert(all.end(), true_sets_[run].begin(), true_sets_[run].end());
    return live(e_.scene, all, e_.body, conditions);
  }

  /// The headline of the first run, recorded exactly.
  double headline_of(const std::vector<Override>& constants, const std::vector<Change>& changes) const {
    std::vector<Override> scene;
    Recorder r;
    for (const Change& c : changes) {
      scene.insert(scene.end(), c.scene.begin(), c.scene.end());
      r = both(r, c.recorder);
    }
    return headline(e_.family, record(e_, history(constants, scene, 0, {}), r).front());
  }

  const Concealable* find(const std::string& name) const {
    for (const Concealable& c : e_.effects)
      if (c.effect == name) return &c;
    return nullptr;
  }
  double strength_of(const Concealable& c) {
    const double size = log_uniform(random_, c.lower, c.upper);
    return c.either_sign && random_.uniform() < 0.5 ? -size : size;
  }
  void conceal(const Concealable& c, double strength) {
    effects_.push_back(c.effect);
    phases_.push_back(c.phase);
    changes_.push_back(c.at(strength));
  }

  bool single() {
    std::vector<const Concealable*> fit;
    for (const Concealable& c : e_.effects)
      if ((level_ != "C2" || !c.phase.empty()) && (level_ != "C4" || c.effect != "time_offset")) fit.push_back(&c);
    if (fit.empty()) return false;
    const Concealable& chosen = *fit[random_.below(fit.size())];
    if (level_ == "C1" && chosen.effect == "sensor_bias") return false;
    conceal(chosen, strength_of(chosen));
    return true;
  }

  bool opposed() {
    if (e_.opposed.empty()) return false;
    const auto& [a, b] = e_.opposed[random_.below(e_.opposed.size())];
    const Concealable &first = *find(a), &second = *find(b);
    const double strong = first.lower * std::pow(first.upper / first.lower, random_.uniform(0.5, 1));
    const double sign = first.either_sign && random_.uniform() < 0.5 ? -1 : 1;
    const Change change = first.at(sign * strong);
    std::vector<Override> constants = nominal_;
    std::erase_if(constants, [&](const Override& o) { return sets(change.scene, o.path); });
    const double plain = headline_of(constants, {}), shifted = headline_of(constants, {change}), wanted = plain + 0.2 * (shifted - plain);
    double best = 0, least = partly * std::abs(shifted - plain);
    for (const double side : {1.0, -1.0}) {
      if (side < 0 && !second.either_sign) continue;
      const auto miss = [&](double u) { return std::abs(headline_of(constants, {change, second.at(side * std::exp(u))}) - wanted); };
      const auto [u, value] = boost::math::tools::brent_find_minima(miss, std::log(second.lower), std::log(second.upper), 12);
      if (value < least - 0.2 * std::abs(shifted - plain)) best = side * std::exp(u), least = value;
    }
    if (best == 0) return false;
    conceal(first, sign * strong);
    conceal(second, best);
    return true;
  }

  /// C1: the constant at which the nominal headline is the true one.
  bool hide() {
    const double truth = headline_of(e_.constants, changes_), plain = headline_of(nominal_, {});
    const auto with_knob = [&](double value) {
      std::vector<Override> constants = nominal_;
      for (Override& o : constants)
        if (o.path == e_.knob) o.value = fmt::format("{}", value);
      return constants;
    };
    const auto miss = [&](double u) { return std::abs(headline_of(with_knob(u), {}) - truth); };
    const auto [value, left] = boost::math::tools::brent_find_minima(miss, e_.knob_lower, e_.knob_upper, 14);
    if (left > headline_match * std::abs(truth - plain)) return false;
    nominal_ = with_knob(value);
    return true;
  }

  /// Forces that no effect is: at times, at places.
  bool outside() {
    const History plain = history(nominal_, {}, 0, {});
    const double weight = plain.mass.at(e_.body) * 9.81, end = plain.time.back();
    const double a = random_.uniform(-std::numbers::pi, std::numbers::pi);
    const Vec3 direction(std::cos(a), std::sin(a), 0);
    const double force = log_uniform(random_, 0.15, 1) * weight;
    const std::uint64_t kind = e_.family == "accelerometer" || e_.family == "spin" ? 0 : random_.below(3);
    const BodyTrack& track = plain.bodies.at(e_.body);
    if (kind == 0) {
      const double from = random_.uniform(0.15, 0.55) * end, length = random_.uniform(0.15, 0.3) * end;
      conditions_.field = [=](double t, const Vec3&, const Vec3&) -> Vec3 {
        const double s = (t - from) / length;
        return s < 0 || s > 1 ? Vec3(Vec3::Zero()) : Vec3(force * std::sin(std::numbers::pi * s) * direction);
      };
      gust_ = {from, from + length};
      outside_ = "outside:gust";
    } else if (kind == 1) {
      const double near = sample(plain, track, 0.3 * end).position.x(), far = sample(plain, track, 0.6 * end).position.x();
      if (far - near < 0.02) return false;
      conditions_.field = [=](double, const Vec3& x, const Vec3&) -> Vec3 {
        return x.x() < near || x.x() > far ? Vec3(Vec3::Zero()) : Vec3(force * direction);
      };
      outside_ = "outside:strip";
    } else {
      const Vec3 centre = sample(plain, track, 0.7 * end).position;
      const double reach = (centre - track.position.front()).head<2>().norm();
      if (reach < 0.05) return false;
      conditions_.field = [=](double, const Vec3& x, const Vec3&) -> Vec3 {
        const Vec3 away(x.x() - centre.x(), x.y() - centre.y(), 0);
        return -2 * force * std::exp(-away.squaredNorm() / (0.1 * reach * reach)) * away / reach;
      };
      outside_ = "outside:attractor";
    }
    return true;
  }

  ConcealedCase written() {
    ConcealedCase made;
    Bundle& bundle = made.bundle;
    bundle.scene.text = with(e_.scene, nominal_);
    if (calibrated_) bundle.calibrate = {e_.knob};
    if (random_.uniform() < 0.5) bundle.noise = e_.noise;
    bundle.split_given = true;
    const TrueSensor sensor = draw_sensor(random_);
    nlohmann::json where = nlohmann::json::object();
    double seen = 0;
    for (std::size_t i = 0; i < e_.runs.size(); ++i) {
      const History truth = history(e_.constants, scene_changes(), i, conditions_);
      BundleRun run;
      run.id = e_.runs[i].id;
      run.set = e_.runs[i].set;
      run.free = e_.free;
      run.held_out = i + held_out_runs >= e_.runs.size();
      run.observations = record(e_, truth, recorder());
      const std::vector<Observation> plain = record(e_, history(nominal_, {}, i, {}), {});
      seen = std::max(seen, signal(run.observations, plain, e_.noise));
      for (std::size_t k = 0; k < run.observations.size(); ++k) {
        Observation& o = run.observations[k];
        disturb(sensor, e_.noise, random_, o);
        o.file = run.observations.size() == 1 ? run.id + ".csv" : fmt::format("{}-{}.csv", run.id, k + 1);
      }
      if (!phases_.empty() && !phases_.front().empty())
        where[run.id] = times_in_phase(truth, e_.body, phases_.front(), 1 / e_.rate);
      else if (gust_[1] > 0)
        where[run.id] = {gust_};
      bundle.runs.push_back(std::move(run));
    }
    if ((!effects_.empty() || !outside_.empty()) && seen < least_signal) throw Error("case", "cannot be seen at all", "draw again");
    nlohmann::json effects = nlohmann::json::array();
    for (std::size_t i = 0; i < effects_.size(); ++i)
      effects.push_back({{"effect", effects_[i]}, {"parameter", changes_[i].parameter}, {"value", changes_[i].value}, {"null", changes_[i].null},
                         {"phase", phases_[i]}});
    if (!outside_.empty()) effects.push_back({{"effect", outside_}});
    std::vector<Override> constants = e_.constants;
    for (const Override& o : scene_changes()) constants.push_back(o);
    made.world = {e_, with(e_.scene, constants), true_sets_, recorder(), conditions_, sensor};
    made.truth = {{"level", level_}, {"family", e_.family}, {"backend", conditions_.backend}, {"step_factor", conditions_.step_factor}, {"effects", effects}, {"where", where},
                  {"sensor", name_of(sensor.kind)}, {"signal", seen}, {"calibrated", calibrated_}};
    return made;
  }

  const std::string level_;
  Random random_;
  const Experiment e_;
  std::vector<Override> nominal_;
  std::vector<std::vector<Override>> true_sets_;
  std::vector<std::string> effects_, phases_;
  std::vector<Change> changes_;
  std::string outside_;
  std::array<double, 2> gust_{0, 0};
  Conditions conditions_;
  bool calibrated_ = false;
};

}  // namespace

const std::vector<std::string>& levels() {
  static const std::vector<std::string> names{"nominal", "C0", "C1", "C2", "C3", "C4", "unknown"};
  return names;
}

ConcealedCase make_case(const std::string& level, std::uint64_t seed) {
  if (std::find(levels().begin(), levels().end(), level) == levels().end())
    throw Error(level, "no such level", fmt::format("known: {}", fmt::join(levels(), ", ")));
  std::string last;
  for (int attempt = 0; attempt < 100; ++attempt) try {
      if (std::optional<ConcealedCase> made = Draft(level, seed, attempt).make()) return *made;
    } catch (const Error& refused) {
      last = refused.what();
    }
  throw Error(level, fmt::format("no case in a hundred draws from seed {}; the last was refused: {}", seed, last), "choose another seed");
}

}  // namespace repose::concealment
