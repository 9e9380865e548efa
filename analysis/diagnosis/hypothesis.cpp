#include "analysis/diagnosis/hypothesis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/bundle/scene_keys.hpp"
#include "analysis/diagnosis/measurement.hpp"
#include "core/error.hpp"
#include "core/scene_yaml.hpp"

namespace repose::diagnosis {
namespace {

constexpr double difference = 1e-3;  // of a parameter's range or value: simulations are exact to far less
constexpr const char* of_positions = "position";  // place of a sensor_bias
constexpr double farthest_origin = 1000;          // mean radii: a camera may have its origin anywhere in the room

/// A finite value to begin from: the one that does nothing, or just inside the bounds.
double first_value(const EffectParameter& p, const EffectBounds& bounds) {
  if (std::isfinite(bounds.nominal) && bounds.nominal >= bounds.lower && bounds.nominal <= bounds.upper) return bounds.nominal;
  return bounds.nominal < bounds.lower ? bounds.lower : p.log_scaled ? bounds.upper : 0.5 * (bounds.lower + bounds.upper);
}

double differencing_step(const EffectParameter& p, const EffectBounds& bounds, double start) {
  return p.log_scaled ? difference * std::max(std::abs(start), 1e-300) : difference * (bounds.upper - bounds.lower);
}

Parameter measured(Parameter::Use use, const std::string& effect, const EffectParameter& p, const EffectBounds& bounds) {
  Parameter result;
  result.use = use;
  result.effect = effect;
  result.key = effect + "." + p.name;
  result.unit = p.unit;
  result.lower = bounds.lower;
  result.upper = bounds.upper;
  result.start = result.null = bounds.nominal;
  result.step = 1e-4 * (bounds.upper - bounds.lower);
  return result;
}

/// How wrong a sensor can be: as much as it reads at most and what is natural for its unit. Its range is no bound: one whose true reading is
/// zero reads nothing but its bias.
double largest_bias(const Observation& o, const NaturalScale& scale) {
  double largest = 0;
  for (const double v : o.value)
    if (std::isfinite(v)) largest = std::max(largest, std::abs(v));
  const double unit = o.name == "specific_force" ? scale.length / (scale.time * scale.time) : o.name == "speed" ? scale.length / scale.time : scale.length;
  return largest + unit;
}

/// A camera keeps its origin from run to run.
std::vector<Parameter> origin_of_positions(const EffectRow& row, const NaturalScale& scale) {
  const double farthest = farthest_origin * scale.length;
  std::vector<Parameter> result(3, measured(Parameter::Use::origin, row.name, row.parameters[0], {-farthest, 0, farthest}));
  for (int axis = 0; axis < 3; ++axis) {
    result[static_cast<std::size_t>(axis)].component = axis;
    result[static_cast<std::size_t>(axis)].unit.assign(1, 'm');  // GCC 12 warns of "m"
  }
  return result;
}

TermParameters of_measurement(const Term& term, const NaturalScale& scale, const std::vector<Observation>& observations) {
  const EffectRow& row = *term.row;
  TermParameters result;
  if (term.place == of_positions) {
    result.shared = origin_of_positions(row, scale);
    return result;
  }
  const auto bounds = [&](std::size_t i) { return bounds_of(row.parameters[i], scale); };
  using Use = Parameter::Use;
  if (row.name == "length_scale") result.shared = {measured(Use::length_scale, row.name, row.parameters[0], bounds(0))};
  if (row.name == "time_scale") result.shared = {measured(Use::time_scale, row.name, row.parameters[0], bounds(0))};
  if (row.name == "time_offset") result.per_run = {measured(Use::time_offset, row.name, row.parameters[0], bounds(0))};
  if (row.name == "frame_tilt")
    result.shared = {measured(Use::tilt_x, row.name, row.parameters[0], bounds(0)), measured(Use::tilt_y, row.name, row.parameters[1], bounds(1))};
  if (row.name == "sensor_bias")
    for (std::size_t i = 0; i < observations.size(); ++i) {
      if (!is_simulated_series(observations[i])) continue;
      const double largest = largest_bias(observations[i], scale);
      Parameter p = measured(Use::bias, row.name, row.parameters[0], {-largest, 0, largest});
      p.component = static_cast<int>(i);
      p.unit = observations[i].unit;
      result.per_run.push_back(p);
    }
  return result;
}

/// Is a key, or a part of it, calibrated, or set by a run for itself?
bool is_free_or_per_run(const Bundle& bundle, const std::string& key) {
  const auto touches = [&](const std::string& other) { return overlap(key, other); };
  return std::any_of(bundle.calibrate.begin(), bundle.calibrate.end(), touches) ||
         std::any_of(bundle.runs.begin(), bundle.runs.end(), [&](const BundleRun& run) {
           return std::any_of(run.set.begin(), run.set.end(), [&](const Override& o) { return touches(o.path); });
         });
}

bool records(const Bundle& bundle, ObservableKind kind) {
  return std::any_of(bundle.runs.begin(), bundle.runs.end(), [&](const BundleRun& run) {
    return std::any_of(run.observations.begin(), run.observations.end(), [&](const Observation& o) { return o.kind == kind; });
  });
}

/// Where a candidate can act: at pairs of materials or at sensors; "" where it has no place.
std::vector<std::string> places_in(const EffectRow& row, const Bundle& bundle) {
  std::vector<std::string> places = places_of(row, bundle.scene);
  if (row.name == "sensor_bias" && records(bundle, ObservableKind::trajectory)) {
    if (records(bundle, ObservableKind::series)) places.emplace_back();
    places.emplace_back(of_positions);
  }
  if (places.empty()) places.emplace_back();
  return places;
}

/// Of any pair.
bool is_calibrated(const Bundle& bundle, const std::string& constant) {
  return std::any_of(bundle.calibrate.begin(), bundle.calibrate.end(), [&](const std::string& key) { return key.starts_with("pairs.") && key.ends_with("." + constant); });
}

/// Does the scene state that the parameter does nothing, however it spells that ("0", "0.00", "0 N")?
bool does_nothing(const YamlNode& node, const EffectParameter& p, double null) {
  if (node.kind == YamlNode::Kind::sequence)
    return std::all_of(node.items.begin(), node.items.end(), [&](const YamlNode& item) { return does_nothing(item, p, null); });
  return node.kind == YamlNode::Kind::scalar && parse_quantity(node.text, p.dimension) == null;
}

}  // namespace

std::vector<std::string> Hypothesis::names() const {
  std::vector<std::string> result;
  for (const Term& term : terms) result.push_back(term.row->name);
  return result;
}

std::string Hypothesis::label() const {
  std::string text;
  for (const Term& term : terms)
    text += (text.empty() ? "" : " + ") + term.row->name + (term.place.empty() ? "" : " (" + term.place + ")");
  return text.empty() ? "nominal" : text;
}

Hypothesis without_numerics(Hypothesis hypothesis) {
  std::erase_if(hypothesis.terms, [](const Term& term) { return term.row->site == EffectSite::numerics; });
  return hypothesis;
}

int stated_in(const Hypothesis& hypothesis) {
  return static_cast<int>(std::count_if(hypothesis.terms.begin(), hypothesis.terms.end(), [](const Term& term) { return !term.stated.empty(); }));
}

TermParameters parameters_of(const Term& term, const NaturalScale& scale, const std::vector<Observation>& observations) {
  if (term.row->site == EffectSite::measurement) return of_measurement(term, scale, observations);
  TermParameters result;
  for (std::size_t n = 0; n < term.row->parameters.size(); ++n) {
    const EffectParameter& p = term.row->parameters[n];
    if ((p.held && !(term.free_reference && !p.held_beside.empty())) || p.key.empty()) continue;
    const EffectBounds bounds = bounds_of(p, scale);
    for (int k = 0; k < p.components; ++k) {
      Parameter q;
      q.key = key_at(p, term.place);
      q.component = p.components == 1 ? -1 : k;
      q.effect = term.row->name;
      q.unit = p.unit;
      q.lower = bounds.lower;
      q.upper = bounds.upper;
      q.null = bounds.nominal;
      q.start = first_value(p, bounds);
      if (!term.stated.empty()) q.null = q.start = term.stated[n];
      q.step = differencing_step(p, bounds, q.start);
      q.logarithmic = p.log_scaled;
      result.shared.push_back(q);
    }
  }
  return result;
}

void put_terms(YamlNode& tree, const Hypothesis& hypothesis, const NaturalScale& scale) {
  for (const Term& term : hypothesis.terms) {
    if (term.row->site == EffectSite::measurement || term.row->site == EffectSite::numerics || !term.stated.empty()) continue;
    std::vector<std::vector<double>> values;
    for (const EffectParameter& p : term.row->parameters)
      values.emplace_back(static_cast<std::size_t>(p.components), first_value(p, bounds_of(p, scale)));
    for (const auto& [path, value] : edits(*term.row, values, term.place)) set_path(tree, path, value);
  }
}

std::vector<Term> possible_terms(const Bundle& bundle, const NaturalScale& scale) {
  const Scene& scene = bundle.scene;
  std::vector<Term> terms;
  const YamlNode tree = parse_yaml(scene.text, "scene");
  for (const EffectRow& row : effect_library()) {
    if (row.site == EffectSite::numerics) continue;
    // Between bodies alone a wall is a body like any other: the claim is that of `friction`.
    if (row.name == "wall_friction" && scene.grains.empty()) continue;
    for (const std::string& place : places_in(row, bundle)) {
      Term term{&row, place};
      bool stated = false;
      for (const EffectParameter& p : row.parameters) {
        if (p.key.empty()) continue;
        const std::string key = key_at(p, place);
        const YamlNode* present = node_at(tree, key);
        if (!p.held_beside.empty()) term.free_reference = scene.grains.empty() && !is_calibrated(bundle, p.held_beside);
        stated = stated || (present != nullptr && !p.held && !does_nothing(*present, p, bounds_of(p, scale).nominal)) || is_free_or_per_run(bundle, key);
      }
      if (stated) continue;
      if (row.site != EffectSite::measurement) {
        if (row.keys.empty() || (row.keys.front().find('*') != std::string::npos && place.empty())) continue;
        try {  // what this version or this scene cannot hold is no candidate
          YamlNode changed = tree;
          put_terms(changed, {{term}}, scale);
          realise(parse_scene(emit_yaml(changed), "scene"), 1);
        } catch (const Error&) {
          continue;
        }
      }
      terms.push_back(term);
    }
  }
  return terms;
}

std::vector<Term> stated_terms(const Bundle& bundle, const NaturalScale& scale) {
  std::vector<Term> terms;
  const YamlNode tree = parse_yaml(bundle.scene.text, "scene");
  for (const EffectRow& row : effect_library()) {
    if (row.site == EffectSite::numerics || row.name == "wall_friction") continue;
    std::vector<std::string> places = places_of(row, bundle.scene);
    if (places.empty()) places.emplace_back();
    for (const std::string& place : places) {
      if (place.empty() && !row.keys.empty() && row.keys.front().find("*") != std::string::npos) continue;
      Term term{&row, place};
      bool given = false, plain = true;
      for (const EffectParameter& p : row.parameters) {
        const YamlNode* node = p.key.empty() ? nullptr : node_at(tree, key_at(p, place));
        const bool number = node != nullptr && node->kind == YamlNode::Kind::scalar;
        plain = plain && !p.key.empty() && p.components == 1 && (node == nullptr || number) && !is_free_or_per_run(bundle, key_at(p, place));
        const EffectBounds bounds = bounds_of(p, scale);
        double value = first_value(p, bounds);
        if (number) value = std::clamp(parse_quantity(node->text, p.dimension), bounds.lower, bounds.upper);
        given = given || (number && !p.held && !does_nothing(*node, p, bounds.nominal));
        term.stated.push_back(value);
      }
      if (given && plain) terms.push_back(term);
    }
  }
  return terms;
}

}  // namespace repose::diagnosis
