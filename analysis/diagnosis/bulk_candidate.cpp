#include "analysis/diagnosis/bulk_candidate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>

#include "analysis/diagnosis/bulk_recording_error.hpp"
#include "analysis/diagnosis/calibrated_constant.hpp"
#include "core/error.hpp"
#include "core/yaml_reader.hpp"
#include "core/scene_yaml.hpp"
#include "core/yaml_tree.hpp"

namespace repose::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::size_t most_stated = 2;  // values of the scene that may be wrong, beside what it lacks: among grains, and as many at walls

/// Heaps flow and stand only in a part of the library's bounds: an attraction of a thousand weights, or honey for air, clogs any outlet.
/// In natural units.
struct BulkRange {
  const char* effect;
  const char* parameter;
  double lower, upper;
};
constexpr BulkRange narrower[] = {
    {"cohesion", "cohesion", 0.1, 100},
    {"liquid_bridge", "force", 0.1, 100},
    {"linear_drag", "viscosity", 1e-3, 1},
    {"finite_reynolds_drag", "viscosity", 1e-3, 1},
};

/// A mass per length and time: the viscosity at which drag at sqrt(g R) is some weights of a grain.
double natural_unit(const std::string& parameter, const NaturalScale& scale) {
  return parameter == "viscosity" ? scale.mass / (scale.length * scale.time) : scale.mass * scale.length / (scale.time * scale.time);
}

bool one_sided(const Parameter& p) { return !p.logarithmic && p.null == p.lower; }

void narrow(Parameter& p, const NaturalScale& scale, bool stated) {
  const std::string last = p.key.substr(p.key.rfind('.') + 1);
  for (const BulkRange& range : narrower)
    if (p.effect == range.effect && last == range.parameter) {
      const double unit = natural_unit(last, scale);
      p.lower = std::max(p.lower, range.lower * unit);
      p.upper = std::min(p.upper, range.upper * unit);
      if (!stated) continue;
      p.lower = std::min(p.lower, p.null);
      p.upper = std::max(p.upper, p.null);
    }
}

BulkCandidate candidate_of(const Term& term, const BulkCandidate& nominal, const NaturalScale& scale) {
  BulkCandidate candidate = nominal;
  candidate.hypothesis.terms = {term};
  for (Parameter p : parameters_of(term, scale, {}).shared) {
    narrow(p, scale, !term.stated.empty());
    candidate.parameters.push_back(p);
  }
  return candidate;
}

bool possible(const Bundle& bundle, const NaturalScale& scale, const BulkCandidate& candidate, const VectorXd& point) {
  try {
    realise(read_scene(bulk_scene(bundle, scale, candidate, point), bundle.scene_file.string(), bundle.scene_file.parent_path()), 1);
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// The axes cut to where the scene can be built: there are shapes that cannot be drawn out further, and grains for which there is no room. Each axis by
/// itself, then all together, for the corners of the cube.
BulkCandidate within_the_possible(BulkCandidate candidate, const Bundle& bundle, const NaturalScale& scale) {
  constexpr int halvings = 8;
  constexpr double margin = 0.95;  // for other seeds
  const std::size_t first = bundle.calibrate.size(), count = candidate.parameters.size() - first;
  const VectorXd none = null_point(candidate, VectorXd::Constant(static_cast<Index>(first), 0.5));
  // The largest share of the way from nothing to `end` that can be built.
  const auto reach = [&](const auto& buildable) {
    if (buildable(1.0)) return 1.0;
    double low = 0, high = 1;
    for (int i = 0; i < halvings; ++i) (buildable(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
    return margin * low;
  };
  const auto towards = [&](VectorXd point, std::size_t axis, double end, double share) {
    const auto k = static_cast<Index>(axis);
    point[k] = none[k] + share * (end - none[k]);
    return point;
  };
  std::vector<double> lower(count), upper(count);
  for (std::size_t i = 0; i < count; ++i)
    for (const double end : {0.0, 1.0}) {
      const double share = reach([&](double s) { return possible(bundle, scale, candidate, towards(none, first + i, end, s)); });
      (end == 0 ? lower : upper)[i] = towards(none, first + i, end, share)[static_cast<Index>(first + i)];
    }
  double together = 1;
  for (std::size_t corner = 0; corner < (std::size_t{1} << count) && count > 1; ++corner)
    together = std::min(together, reach([&](double s) {
      VectorXd point = none;
      for (std::size_t i = 0; i < count; ++i) point = towards(point, first + i, (corner >> i) % 2 == 0 ? lower[i] : upper[i], s);
      return possible(bundle, scale, candidate, point);
    }));
  const std::vector<Parameter> whole = candidate.parameters;
  for (std::size_t i = 0; i < count; ++i) {
    Parameter& p = candidate.parameters[first + i];
    const double null = none[static_cast<Index>(first + i)];
    p.lower = value_at(whole[first + i], null + together * (lower[i] - null));
    p.upper = value_at(whole[first + i], null + together * (upper[i] - null));
  }
  return candidate;
}

/// A law of contacts acts between grains, unless it is a wall's.
bool among_grains(const Term& term, const Scene& scene) {
  if (term.place.empty() || term.row->name == "wall_friction") return true;
  for (const GrainPopulation& a : scene.grains)
    for (const GrainPopulation& b : scene.grains)
      if (term.place == std::min(a.material, b.material) + "-" + std::max(a.material, b.material)) return true;
  return false;
}

/// What the scene states and may have wrong. A wall's friction is an effect of its own, which has the same key as that among grains; where a wall
/// is made of what the grains are, theirs and its cannot be set apart, and it is called theirs.
std::vector<Term> stated_of_grains(const Bundle& bundle, const NaturalScale& scale) {
  std::vector<Term> terms = stated_terms(bundle, scale);
  const EffectRow* of_walls = find_effect("wall_friction");
  const std::vector<std::string> walls = places_of(*of_walls, bundle.scene);
  for (Term& term : terms)
    if (term.row->name == "friction" && !among_grains(term, bundle.scene) && std::find(walls.begin(), walls.end(), term.place) != walls.end()) term.row = of_walls;
  return terms;
}

}  // namespace

const std::vector<std::string>& bulk_effects() {
  static const std::vector<std::string> names{"friction",        "rolling_friction",        "cohesion",          "grain_shape",   "size_distribution",
                                              "restitution",     "finite_reynolds_drag",    "spinning_friction", "wall_friction", "rate_dependent_friction",
                                              "liquid_bridge",   "moving_wall_speed",       "base_vibration"};
  return names;
}

double value_at(const Parameter& p, double u) {
  if (p.logarithmic) return std::exp(std::log(p.lower) + u * (std::log(p.upper) - std::log(p.lower)));
  return p.lower + (one_sided(p) ? u * u : u) * (p.upper - p.lower);
}

double coordinate_of(const Parameter& p, double value) {
  const double u = p.logarithmic ? (value > 0 ? (std::log(value) - std::log(p.lower)) / (std::log(p.upper) - std::log(p.lower)) : 0)
                                 : (value - p.lower) / (p.upper - p.lower);
  const double inside = std::isnan(u) ? 0 : std::clamp(u, 0.0, 1.0);
  return one_sided(p) ? std::sqrt(inside) : inside;
}

VectorXd null_point(const BulkCandidate& candidate, const VectorXd& calibrated) {
  VectorXd point(static_cast<Index>(candidate.parameters.size()));
  for (Index i = 0; i < point.size(); ++i) {
    const Parameter& p = candidate.parameters[static_cast<std::size_t>(i)];
    point[i] = i < calibrated.size() && p.effect.empty() ? calibrated[i] : coordinate_of(p, p.null);
  }
  return point;
}

BulkCandidate nominal_candidate(const Bundle& bundle, const NaturalScale& scale) {
  BulkCandidate nominal;
  const YamlNode tree = parse_yaml(bundle.scene.text, "scene");
  for (const std::string& key : bundle.calibrate) nominal.parameters.push_back(calibrated_constant(key, tree, scale));
  return nominal;
}

std::vector<BulkCandidate> bulk_candidates(const Bundle& bundle, const NaturalScale& scale, const std::vector<std::string>& wanted, std::size_t most) {
  std::vector<std::string> known;
  for (const EffectRow& row : effect_library()) known.push_back(row.name);
  for (const std::string& name : wanted)
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      const Suggestion suggestion = suggest("the library has no effect", name, known);
      throw Error("--candidates", suggestion.problem, suggestion.remedy);
    }
  const BulkCandidate nominal = nominal_candidate(bundle, scale);
  std::vector<BulkCandidate> result;
  std::vector<std::string> taken;
  std::vector<Term> terms = possible_terms(bundle, scale);
  for (Term& term : stated_of_grains(bundle, scale)) terms.push_back(std::move(term));
  std::size_t missing = 0, stated = 0, stated_of_walls = 0;
  for (const std::string& name : wanted.empty() ? bulk_effects() : wanted)
    for (const Term& term : terms) {
      if (term.row->name != name || term.row->site == EffectSite::measurement || !among_grains(term, bundle.scene)) continue;
      if (std::size_t& count = term.stated.empty() ? missing : name == "wall_friction" ? stated_of_walls : stated; wanted.empty() && count++ >= (term.stated.empty() ? most : most_stated)) continue;
      result.push_back(within_the_possible(candidate_of(term, nominal, scale), bundle, scale));
      taken.push_back(name);
    }
  for (BulkCandidate& c : recording_errors(bundle, scale)) {
    const std::string name = c.hypothesis.names().front();
    taken.push_back(name);
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end()) result.push_back(std::move(c));
  }
  for (const std::string& name : wanted)  // numerics are no candidates, and always tried
    if (find_effect(name)->site != EffectSite::numerics && std::find(taken.begin(), taken.end(), name) == taken.end())
      throw Error("--candidates " + name, "the scene has it already, or cannot take it", "leave it out, or remove the key from the nominal scene");
  return result;
}

BulkCandidate together(const BulkCandidate& a, const BulkCandidate& b) {
  using Kind = BulkCandidate::Kind;
  BulkCandidate pair;
  pair.kind = a.kind == Kind::simulated || b.kind == Kind::simulated ? Kind::simulated : Kind::recording;
  for (const BulkCandidate* part : {&a, &b})
    for (const Term& term : part->hypothesis.terms) pair.hypothesis.terms.push_back(term);
  // Calibrated constants first, of which both know the same, then the scene's, then the recording's.
  for (const BulkCandidate* part : {&a, &b})
    for (const Parameter& p : part->parameters)
      if (p.effect.empty() && axis_of(pair, p) < 0) pair.parameters.push_back(p);
  for (const bool of_scene : {true, false})
    for (const BulkCandidate* part : {&a, &b})
      for (const Parameter& p : part->parameters)
        if (!p.effect.empty() && (p.use == Parameter::Use::scene) == of_scene) pair.parameters.push_back(p);
  return pair;
}

Index axis_of(const BulkCandidate& candidate, const Parameter& parameter) {
  const auto found = std::find_if(candidate.parameters.begin(), candidate.parameters.end(), [&](const Parameter& p) {
    return p.use == parameter.use && p.key == parameter.key && p.component == parameter.component;
  });
  return found == candidate.parameters.end() ? -1 : found - candidate.parameters.begin();
}

Index scene_axes(const BulkCandidate& candidate) {
  return std::count_if(candidate.parameters.begin(), candidate.parameters.end(), [](const Parameter& p) { return p.use == Parameter::Use::scene; });
}

std::vector<Override> values_at(const BulkCandidate& candidate, const VectorXd& point) {
  std::vector<Override> values;
  for (std::size_t i = 0; i < candidate.parameters.size(); ++i) {
    const Parameter& p = candidate.parameters[i];
    if (p.use != Parameter::Use::scene) continue;
    values.push_back({p.component < 0 ? p.key : fmt::format("{}.{}", p.key, p.component), fmt::format("{}", value_at(p, point[static_cast<Index>(i)]))});
  }
  return values;
}

YamlNode bulk_scene(const Bundle& bundle, const NaturalScale& scale, const BulkCandidate& candidate, const VectorXd& point,
                    const std::vector<Override>& set) {
  YamlNode tree = parse_yaml(bundle.scene.text, "scene");
  for (const Override& change : set) set_path(tree, change.path, change.value);
  if (candidate.kind == BulkCandidate::Kind::recording) return tree;
  if (candidate.kind == BulkCandidate::Kind::numerics) {
    const std::string& solved = candidate.hypothesis.terms.front().row->name;
    if (solved == "time_step") set_path(tree, "solver.time_step", fmt::format("{}", 0.25 * bundle.scene.solver.time_step));
    if (solved == "solver_tolerance") set_path(tree, "solver.tolerance", fmt::format("{}", 0.1 * bundle.scene.solver.tolerance));
    for (const Override& constant : candidate.calibrated) set_path(tree, constant.path, constant.value);
    return tree;
  }
  put_terms(tree, candidate.hypothesis, scale);
  for (const Override& value : values_at(candidate, point)) set_path(tree, value.path, value.value);
  return tree;
}

Eigen::MatrixXd space_filling(int count, Index axes) {
  Eigen::MatrixXd points(count, axes);
  if (axes == 1)
    for (int i = 0; i < count; ++i) points(i, 0) = (i + 0.5) / count;
  if (axes < 2) return points;
  boost::random::sobol sequence(static_cast<std::size_t>(axes));
  for (int i = 0; i < count; ++i)
    for (Index k = 0; k < axes; ++k) points(i, k) = static_cast<double>(sequence()) / static_cast<double>(boost::random::sobol::max());
  return points;
}

}  // namespace repose::diagnosis
