#include "analysis/diagnosis/problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "analysis/diagnosis/calibrated_constant.hpp"
#include "analysis/diagnosis/recorded_noise.hpp"
#include "analysis/diagnosis/scene_values.hpp"
#include "analysis/diagnosis/segments.hpp"
#include "analysis/diagnosis/start_values.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/scene_yaml.hpp"

namespace repose::diagnosis {
namespace {

constexpr double largest_numerics = 3;  // of the noise: a coarser step is for the candidate `time_step` to tell
constexpr double unnoticed_numerics = 0.02;
constexpr double steps_of_a_sample = 10;  // at least: what is faster than samples are taken cannot be told, but solved it must be
constexpr double periods_seen = 2;       // in the longest recording, of what is called periodic: beside a constant force one and a half are any push that passes

Values starts(const std::vector<Parameter>& parameters) {
  Values v(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) v[static_cast<Eigen::Index>(i)] = parameters[i].start;
  return v;
}

/// Of the numbers that a run's channels are compared with.
std::uint64_t fingerprint(const RunData& data) {
  std::string bytes;
  const auto put = [&](double x) { bytes.append(reinterpret_cast<const char*>(&x), sizeof x); };
  for (const Channel& c : data.channels) {
    bytes += fmt::format("{} {} {} {};", c.observable, c.body, c.observation, c.axis);
    const Observation& o = data.run->observations[c.observation];
    if (o.axis) bytes += fmt::format("{} {} {};", o.axis->x(), o.axis->y(), o.axis->z());
    for (std::size_t k = 0; k < c.time.size(); ++k) {
      put(c.time[k]);
      if (c.observable == "position") put(o.position[c.at[k]][c.axis]);
      if (c.observable == "orientation")
        for (const double x : o.orientation[c.at[k]].coeffs()) put(x);
      if (!o.value.empty()) put(o.value[c.at[k]]);
    }
  }
  return checksum(bytes);
}

}  // namespace

Problem::Problem(const Bundle& bundle, const std::vector<std::size_t>& runs, Simulate simulate, SimulationStore* store, bool coarser_step)
    : bundle_(bundle),
      simulate_(std::move(simulate)),
      scale_(natural_scale(realise(bundle.scene, 1))),
      noise_(recorded_noise(bundle, runs)),
      store_(store != nullptr ? store : &own_store_) {
  const YamlNode tree = parse_yaml(bundle.scene.text, "scene");
  for (const std::string& key : bundle.calibrate) calibrated_.push_back(calibrated_constant(key, tree, scale_));
  for (const std::size_t index : runs) add_run(index);
  choose_numerics(coarser_step);
  add_numerics();
  for (std::size_t run = 0; run < runs_.size(); ++run) runs_[run].hits = hits(run);
}

bool Problem::hits(std::size_t run) const {
  try {
    const Layout nominal = layout({});
    const History path = history(nominal, run, starts(nominal.shared), starts(runs_[run].start));
    return std::any_of(path.bodies.begin(), path.bodies.end(), [&](const auto& body) {
      const std::vector<Phase> phases = phases_of(path, body.second, path.radius.at(body.first));
      return std::find(phases.begin(), phases.end(), Phase::impact) != phases.end();
    });
  } catch (const Error&) {
    return false;  // cannot be simulated from where it begins: nothing is known of its path
  }
}

void Problem::add_run(std::size_t index) {
  RunData data;
  data.run = &bundle_.runs[index];
  data.tree = parse_yaml(bundle_.scene.text, "scene");
  for (const Override& change : data.run->set) set_path(data.tree, change.path, change.value);
  std::map<std::string, double> noise;
  for (const auto& [name, model] : noise_) noise[name] = model.sd;
  data.start = start_values(*data.run, data.tree, noise);
  for (const Observation& o : data.run->observations)
    if (!o.time.empty()) data.recorded = std::max(data.recorded, o.time.back());
  data.horizon = data.recorded;
  set_up_channels(data);
  if (data.size == 0)
    throw Error("run " + data.run->id, "holds nothing that a few-body simulation can be compared with",
                "give a trajectory, or a series specific_force, speed or height");
  runs_.push_back(std::move(data));
}

void Problem::set_up_channels(RunData& data) const {
  data.channels.clear();
  data.size = 0;
  const auto add = [&](const std::string& observable, std::size_t observation, int axis, const auto& observed) {
    const Observation& o = data.run->observations[observation];
    Channel c;
    c.observable = observable;
    c.body = o.body;
    c.observation = observation;
    c.axis = axis;
    const auto noise = noise_.find(observable);
    c.noise = noise == noise_.end() || noise->second.sd == 0 ? 1e-6 : noise->second.sd;
    c.phi = noise == noise_.end() ? 0 : noise->second.phi;
    c.first = data.size;
    for (std::size_t i = 0; i < o.time.size(); ++i)
      if (o.time[i] <= data.horizon && observed(i)) {
        c.time.push_back(o.time[i]);
        c.at.push_back(i);
      }
    data.size += static_cast<Eigen::Index>(c.time.size());
    data.channels.push_back(std::move(c));
  };
  for (std::size_t n = 0; n < data.run->observations.size(); ++n) {
    const Observation& o = data.run->observations[n];
    if (o.kind == ObservableKind::trajectory) {
      for (int k = 0; k < 3; ++k) add("position", n, k, [&](std::size_t i) { return std::isfinite(o.position[i][k]); });
      if (!o.orientation.empty())
        for (int k = 0; k < 3; ++k) add("orientation", n, k, [&](std::size_t i) { return std::isfinite(o.orientation[i].w()); });
    } else if (is_simulated_series(o)) {
      add(o.name, n, 0, [&](std::size_t i) { return std::isfinite(o.value[i]); });
    }
  }
  data.fingerprint = fingerprint(data);
}

void Problem::follow(std::size_t run, const Values& own, const Eigen::MatrixXd& spread) {
  RunData& data = runs_[run];
  const double before = std::min(data.horizon, data.recorded);
  for (std::size_t i = 0; i < data.start.size(); ++i) data.start[i].start = own[static_cast<Eigen::Index>(i)];
  data.horizon = data.recorded;
  set_up_channels(data);
  const double horizon = std::max(before, linear_until(run, own, spread));
  if (horizon >= data.horizon) return;
  data.horizon = horizon;
  set_up_channels(data);
}

/// Where the response to the uncertainty of the start is no longer a straight line, a fit has nothing to hold on to.
double Problem::linear_until(std::size_t run, const Values& own, const Eigen::MatrixXd& spread) const {
  const RunData& data = runs_[run];
  const Eigen::Index k = spread.cols();
  double horizon = data.horizon;
  const Layout nominal = layout({});
  const Values shared = starts(nominal.shared);
  const Eigen::VectorXd middle = plain_residual(nominal, run, shared, own);
  for (int trial = 0; trial < 4 && k > 0; ++trial) {
    Values signs(k);
    for (Eigen::Index i = 0; i < k; ++i) signs[i] = ((trial >> (i % 2)) + (i / 2) * trial) % 2 == 0 ? 1 : -1;
    const Values change = spread * signs;
    const Eigen::VectorXd up = plain_residual(nominal, run, shared, own + change), down = plain_residual(nominal, run, shared, own - change);
    if (middle.size() == 0 || up.size() == 0 || down.size() == 0) continue;
    for (const Channel& c : data.channels) {
      int bent_for = 0;
      for (std::size_t i = 0; i < c.time.size(); ++i) {
        const Eigen::Index at = c.first + static_cast<Eigen::Index>(i);
        const double bent = std::abs(up[at] + down[at] - 2 * middle[at]), straight = std::abs(up[at] - down[at]);
        bent_for = bent > std::max(5.0, 0.3 * straight) ? bent_for + 1 : 0;
        if (bent_for == 3) {
          horizon = std::min(horizon, c.time[i]);
          break;
        }
      }
    }
  }
  return horizon;
}

void Problem::choose_numerics(bool coarser_step) {
  numerics_.second_order = true;
  if (parting(numerics_, numerics_).empty()) numerics_ = {};
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    const std::vector<Parameter>& start = runs_[run].start;
    Values twice(static_cast<Eigen::Index>(start.size()));
    for (std::size_t i = 0; i < start.size(); ++i) twice[static_cast<Eigen::Index>(i)] = 2 * start[i].step;
    runs_[run].horizon = 0;
    follow(run, starts(start), twice.asDiagonal());
  }
  if (coarser_step) coarsen_step();
}

/// Every run, from its first start values.
bool Problem::simulated_by(const Numerics& numerics) const {
  Layout so = layout({});
  so.numerics = numerics;
  for (std::size_t run = 0; run < runs_.size(); ++run)
    if (plain_residual(so, run, starts(so.shared), starts(runs_[run].start)).size() == 0) return false;
  return true;
}

void Problem::coarsen_step() {
  const auto sets_step = [](const Override& set) { return set.path.starts_with("solver."); };
  for (const RunData& data : runs_)
    if (std::any_of(data.run->set.begin(), data.run->set.end(), sets_step)) return;
  double between = std::numeric_limits<double>::infinity();
  for (const RunData& data : runs_)
    for (const Channel& c : data.channels)
      for (std::size_t k = 1; k < c.time.size(); ++k) between = std::min(between, c.time[k] - c.time[k - 1]);
  for (const double factor : {8.0, 4.0, 2.0}) {
    if (!numerics_.second_order || bundle_.scene.solver.time_step * factor > between / steps_of_a_sample) continue;
    Numerics coarse = numerics_;
    coarse.step_factor = factor;
    const std::map<std::string, double> moved = parting(coarse, numerics_, 1);
    if (moved.empty() || !simulated_by(coarse) || std::any_of(moved.begin(), moved.end(), [](const auto& m) { return !(m.second < unnoticed_numerics); })) continue;
    numerics_ = coarse;
    return;
  }
}

void Problem::add_numerics() {
  for (const auto& [name, model] : noise_) sensor_noise_[name] = model.sd;
  Numerics fine = numerics_;
  fine.step_factor = 0.5 * numerics_.step_factor;
  const std::map<std::string, double> ours = parting(numerics_, fine);
  if (numerics_.second_order) scene_error_ = parting({}, numerics_);
  for (const auto& [name, error] : ours) {
    const auto scene = scene_error_.find(name);
    const double maker = scene == scene_error_.end() ? 0 : step_of_makers * std::min(scene->second, largest_numerics);
    const double larger = std::hypot(1.0, std::min(error, largest_numerics), maker);
    noise_[name].sd *= larger;
    if (scene != scene_error_.end()) scene->second /= larger;
  }
  for (RunData& data : runs_)
    for (Channel& c : data.channels)
      if (const auto noise = noise_.find(c.observable); noise != noise_.end() && noise->second.sd > 0) c.noise = noise->second.sd;
}

std::map<std::string, double> Problem::parting(const Numerics& one, const Numerics& other, double share) const {
  std::map<std::string, std::vector<double>> errors;
  Layout first = layout({}), second = first;
  first.numerics = one;
  second.numerics = other;
  const Values shared = starts(first.shared);
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    const Values own = starts(runs_[run].start);
    const Eigen::VectorXd a = plain_residual(first, run, shared, own), b = plain_residual(second, run, shared, own);
    if (a.size() == 0 || b.size() == 0) continue;
    const Eigen::VectorXd parted = beyond_start_values(second, run, shared, a - b);
    std::map<std::string, std::pair<double, double>> squares;  // sum and number
    for (const Channel& c : runs_[run].channels) {
      auto& [sum, number] = squares[c.observable];
      sum += parted.segment(c.first, static_cast<Eigen::Index>(c.time.size())).squaredNorm();
      number += static_cast<double>(c.time.size());
    }
    for (const auto& [name, s] : squares)
      if (s.second > 0) errors[name].push_back(std::sqrt(s.first / s.second));
  }
  std::map<std::string, double> quantiles;
  for (auto& [name, list] : errors) {
    const auto at = list.begin() + std::min(static_cast<std::ptrdiff_t>(share * static_cast<double>(list.size())), static_cast<std::ptrdiff_t>(list.size()) - 1);
    std::nth_element(list.begin(), at, list.end());
    quantiles[name] = *at;
  }
  return quantiles;
}

Eigen::VectorXd Problem::beyond_start_values(const Layout& layout, std::size_t run, const Values& shared, Eigen::VectorXd of) const {
  const Values own = starts(runs_[run].start);
  if (own.size() == 0 || of.isZero()) return of;
  Eigen::MatrixXd responses(of.size(), own.size());
  for (Eigen::Index i = 0; i < own.size(); ++i) {
    const Values step = Values::Unit(own.size(), i) * runs_[run].start[static_cast<std::size_t>(i)].step;
    const Eigen::VectorXd up = plain_residual(layout, run, shared, own + step), down = plain_residual(layout, run, shared, own - step);
    responses.col(i).setZero();
    if (up.size() > 0 && down.size() > 0) responses.col(i) = up - down;
    if (const double size = responses.col(i).norm(); size > 0) responses.col(i) /= size;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(responses);
  of -= responses * qr.solve(of);
  return of;
}

/// What did not come again within a recording was not seen to be periodic: a push that passes is imitated by a part of a wave. And of a force samples show
/// half a period at least: a faster one gives as good as random kicks from one impact to the next, among which some frequency fits whatever is left. (What
/// shakes the ground may be faster than the camera: how high a body is thrown shows it.)
void Problem::see_periods(Parameter& frequency) const {
  if (!frequency.key.ends_with(".frequency")) return;
  double longest = 0, shortest = std::numeric_limits<double>::infinity();
  for (const RunData& data : runs_) {
    longest = std::max(longest, data.horizon);
    for (const Channel& c : data.channels)
      if (c.time.size() > 1) shortest = std::min(shortest, (c.time.back() - c.time.front()) / static_cast<double>(c.time.size() - 1));
  }
  if (frequency.effect == "periodic_force") frequency.upper = std::max(frequency.lower, std::min(frequency.upper, 0.5 / shortest));
  if (longest > 0) frequency.lower = std::min(frequency.upper, std::max(frequency.lower, periods_seen / longest));
  frequency.start = std::max(frequency.start, frequency.lower);
}

Layout Problem::layout(const Hypothesis& hypothesis) const {
  Layout result;
  result.hypothesis = hypothesis;
  result.numerics = numerics_;
  result.shared = calibrated_;
  for (const RunData& data : runs_) result.per_run.push_back(data.start);
  for (const Term& term : hypothesis.terms) {
    TermParameters shared = parameters_of(term, scale_, {});
    for (Parameter& p : shared.shared) see_periods(p);
    result.shared.insert(result.shared.end(), shared.shared.begin(), shared.shared.end());
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      const TermParameters own = parameters_of(term, scale_, runs_[i].run->observations);
      result.per_run[i].insert(result.per_run[i].end(), own.per_run.begin(), own.per_run.end());
    }
  }
  return result;
}

YamlNode Problem::solved_by(YamlNode tree, const Layout& layout) const {
  const SolverOptions& solver = bundle_.scene.solver;
  const Numerics& how = layout.numerics;
  if (how.step_factor != 1) set_path(tree, "solver.time_step", fmt::format("{}", solver.time_step * how.step_factor));
  if (how.tolerance_factor != 1) set_path(tree, "solver.tolerance", fmt::format("{}", solver.tolerance * how.tolerance_factor));
  if (how.second_order) set_path(tree, "solver.integration", "second_order");
  if (!how.backend.empty()) {  // what other engines do not have
    set_path(tree, "solver.integration", "symplectic_euler");
    set_path(tree, "solver.law", "exact");
  }
  if (how.other_law) set_path(tree, "solver.law", solver.law == ContactLaw::exact ? "relaxed" : "exact");
  return tree;
}

YamlNode Problem::scene(const Layout& layout, std::size_t run, const Values& shared, const Values& own) const {
  const RunData& data = runs_[run];
  std::vector<Quat> orientations;
  for (const Parameter& p : layout.per_run[run]) {
    if (p.use != Parameter::Use::turn || p.component != 0) continue;
    for (const Observation& o : data.run->observations) {
      if (p.key != "bodies." + o.body + ".orientation") continue;
      const auto seen = std::find_if(o.orientation.begin(), o.orientation.end(), [](const Quat& q) { return std::isfinite(q.w()); });
      if (seen != o.orientation.end()) orientations.push_back(*seen);
      break;
    }
  }
  YamlNode tree = data.tree;
  put_terms(tree, layout.hypothesis, scale_);
  put_values(tree, layout.shared, shared);
  put_values(tree, layout.per_run[run], own, orientations);
  return solved_by(std::move(tree), layout);
}

YamlNode Problem::extended_scene(const Layout& layout, const Values& shared) const {
  YamlNode tree = parse_yaml(bundle_.scene.text, "scene");
  put_terms(tree, layout.hypothesis, scale_);
  put_values(tree, layout.shared, shared);
  Layout as_stated = layout;  // a coarser step is for the fits; whoever runs the scene gets his own
  if (layout.numerics.step_factor == numerics_.step_factor) as_stated.numerics.step_factor = std::min(1.0, numerics_.step_factor);
  return solved_by(std::move(tree), as_stated);
}

History Problem::history(const Layout& layout, std::size_t run, const Values& shared, const Values& own) const {
  const Scene made = read_scene(scene(layout, run, shared, own), bundle_.scene_file.string(), bundle_.scene_file.parent_path());
  SimulationRequest request;
  request.scene = &made;
  request.backend = layout.numerics.backend;
  request.contacts = true;
  request.until = std::max(runs_[run].horizon, 2 * made.solver.time_step);
  return simulate_(request);
}

Eigen::VectorXd Problem::residual(const Layout& layout, std::size_t run, const Values& shared, const Values& own,
                                  const std::vector<WindowLoad>& loads) const {
  Eigen::VectorXd r = plain_residual(layout, run, shared, own, loads);
  if (r.size() == 0) return r;
  for (const Channel& c : runs_[run].channels)
    if (c.phi > 0) whiten(r.segment(c.first, static_cast<Eigen::Index>(c.time.size())), c.phi, c.time);
  return r;
}

Eigen::VectorXd Problem::plain_residual(const Layout& layout, std::size_t run, const Values& shared, const Values& own,
                                        const std::vector<WindowLoad>& loads) const {
  const RunData& data = runs_[run];
  Measurement m;
  take(layout.shared, shared, m);
  take(layout.per_run[run], own, m);
  YamlNode tree = scene(layout, run, shared, own);
  std::string key = tree_key(tree) + fmt::format("|{}|", data.fingerprint) + m.text();
  for (const WindowLoad& load : loads)
    key += fmt::format("|{} {} {} {} {} {} {} {} {}", load.body, load.from, load.to, load.force.x(), load.force.y(), load.force.z(),
                       load.torque.x(), load.torque.y(), load.torque.z());
  if (!layout.numerics.backend.empty()) key += "|" + layout.numerics.backend;
  const std::uint64_t hash = checksum(key);
  std::optional<Eigen::VectorXd> d = store_->find(hash);
  if (!d) {
    ++simulations_;
    d.emplace();
    try {
      const Scene made = read_scene(std::move(tree), bundle_.scene_file.string(), bundle_.scene_file.parent_path());
      SimulationRequest request;
      request.scene = &made;
      request.backend = layout.numerics.backend;
      request.loads = loads;
      request.until = std::max(m.true_time(data.horizon) + 2 * made.solver.time_step, 4 * made.solver.time_step);
      d = difference(simulate_(request), *data.run, data.channels, m);
      if (!d->allFinite()) d->resize(0);
    } catch (const Error& problem) {
      if (problem.problem() == "interrupted") return {};  // not a result; whoever asked sees the interruption for himself
    }
    store_->add(hash, *d);
  }
  Eigen::VectorXd& r = *d;
  if (r.size() == 0) return r;
  for (const Channel& c : data.channels) r.segment(c.first, static_cast<Eigen::Index>(c.time.size())) /= c.noise;
  return r.cwiseMax(-largest_residual).cwiseMin(largest_residual);
}

}  // namespace repose::diagnosis
