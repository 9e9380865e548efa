#pragma once
/// A claim about what is missing: effects of the library, each at its place, and the parameters that a fit may turn.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "analysis/bundle/bundle.hpp"
#include "core/effect_library.hpp"
#include "core/yaml_tree.hpp"

namespace repose::diagnosis {

/// One effect of the library, with the pair of materials where it acts (empty if it has no place), or "position" for a sensor_bias of
/// trajectories. Either the scene lacks it, or the scene states its values and these may be wrong.
struct Term {
  const EffectRow* row = nullptr;
  std::string place;
  std::vector<double> stated = {};  ///< by the scene, one for each parameter of the row; empty: the scene lacks the effect
  bool free_reference = false;      ///< EffectParameter::held_beside is stated: its partner is fitted, too
};

/// Sorted terms; none: the nominal scene.
struct Hypothesis {
  std::vector<Term> terms;
  std::vector<std::string> names() const;
  std::string label() const;  ///< "rolling_friction (ball-floor) + time_offset"; "nominal"
};

/// What is solved more finely is no effect of the world: hypotheses that extend it name only their own.
Hypothesis without_numerics(Hypothesis hypothesis);

/// Terms that contradict the scene instead of adding to it.
int stated_in(const Hypothesis& hypothesis);

/// One number that a fit turns.
struct Parameter {
  enum class Use {
    scene,         ///< component `component` of the value at `key`
    turn,          ///< component of a rotation vector [rad] applied to the start orientation at `key`
    length_scale, time_scale, time_offset, tilt_x, tilt_y,  ///< of the recording
    bias,          ///< of observation `component` of the run
    origin,        ///< component of Measurement::origin
  } use = Use::scene;
  std::string key;      ///< scene path, or "length_scale.factor"
  int component = -1;   ///< -1: a plain number
  std::string effect;   ///< of the library; "" for calibrated constants and start values
  std::string unit;
  double lower = -1e300, upper = 1e300;
  double start = 0;
  double null = 0;      ///< where it does nothing
  double step = 1e-6;   ///< for finite differences
  double read = std::numeric_limits<double>::quiet_NaN();  ///< a start value as read off the data; `start` may have moved to where the nominal fit led
  double told = std::numeric_limits<double>::quiet_NaN();  ///< a start value as the scene has it
  double prior_sd = 0;  ///< of a weak prior about begin(), for what a run does not determine; 0: none
  bool logarithmic = false;

  /// A start value as the data have it (or, of a body's mass, the scene); of anything else where a fit begins.
  double begin() const { return std::isfinite(read) ? read : start; }
};

/// Parameters of the terms: those shared by all runs, and (time_offset, sensor_bias of a series) one per run. Held ones and values
/// that the scene states are not turned.
struct TermParameters {
  std::vector<Parameter> shared, per_run;
};
TermParameters parameters_of(const Term& term, const NaturalScale& scale, const std::vector<Observation>& observations);

/// Every effect of the library that the scene does not have yet and that can be set in it: one term per place. What is calibrated is free already and
/// explains nothing new; for what a run sets for itself no one value could take its place.
std::vector<Term> possible_terms(const Bundle& bundle, const NaturalScale& scale);

/// The constants that the scene states without having them calibrated: contact laws and effects of plain numbers. What a run sets
/// for itself is not among them.
std::vector<Term> stated_terms(const Bundle& bundle, const NaturalScale& scale);

/// Sets the terms' keys in a scene tree to their nominal or start values; parameters are set over these. What the scene states stays.
void put_terms(YamlNode& tree, const Hypothesis& hypothesis, const NaturalScale& scale);

}  // namespace repose::diagnosis
