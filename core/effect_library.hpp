#pragma once
/// Every effect that a scene or a recording can be missing, as plain data: what a diagnosis chooses from.
///
/// A row is a claim with parameters. To assume it, set its keys in the YAML of the scene (yaml_tree.hpp, `--set`):
///   for (const auto& [path, value] : edits(row, values, "pa12-steel")) set_path(tree, path, value);
/// The laws themselves stand beside their structs: effect.hpp (bodies), contact_effects.hpp (contacts),
/// setup_effects.hpp (set-up), material.hpp (pairs). Measurement errors are applied to a recording, not to a scene:
/// their rows have no keys.
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/quantity.hpp"

namespace repose {

struct Model;
struct Scene;

enum class EffectSite : std::uint8_t {
  body,         ///< a load on every body
  contact,      ///< a law of contacts
  setup,        ///< the things themselves: shapes, sizes, inertia, tools
  measurement,  ///< of the recording, not of the world
  numerics,     ///< of the simulation, not of the world
};

struct EffectParameter {
  std::string name;  ///< "viscosity"
  std::string key;   ///< path in the scene, "effects.linear_drag.viscosity"; `*` stands for a name; "": not of a scene
  std::string unit;  ///< "Pa s", "1", "deg"
  Dimension dimension;  ///< of the SI value (degrees: none)
  double lower = 0;     ///< of the values that are worth a search
  double nominal = 0;   ///< does nothing. Outside the bounds: a limit, reached by leaving the effect out. A parameter
                       ///< that does nothing alone (a frequency) has its first guess here.
  double upper = 0;
  bool log_scaled = false;  ///< search in ln(value)
  bool natural = false;     ///< lower, nominal, upper are multiples of the natural scale: bounds_of() makes them SI
  bool held = false;   ///< only its product with another parameter can be seen: held at `nominal` unless it is known
  std::string held_beside = {};  ///< that other one, where it is a constant of the pairs ("friction"): a search holds this one only while it is calibrated
  int components = 1;  ///< 3: a vector, each component within the bounds
};

struct EffectRow {
  std::string name;  ///< as formats and diagnoses know it
  EffectSite site = EffectSite::body;
  std::string claim;  ///< one sentence
  std::string moves;  ///< the observables that show it
  std::vector<EffectParameter> parameters;
  std::vector<std::string> keys;  ///< of the scene, those of the parameters or, without any, those that replace them
  std::string limit = {};  ///< the plainer effect that it becomes at one end of what it describes; empty: none
};

/// All rows, in a fixed order: bodies, contacts, set-up, measurement, numerics.
const std::vector<EffectRow>& effect_library();

/// The row of a name, or nullptr.
const EffectRow* find_effect(const std::string& name);

/// A length, a mass and a time of the scene: mean radius and mass of the bodies that move, and sqrt(length / |g|) (with
/// |g| = 9.81 m/s^2 where there is no gravity). A quantity of dimension length^a mass^b time^c is measured in them.
struct NaturalScale {
  double length = 1, mass = 1, time = 1;  ///< [m], [kg], [s]
};
NaturalScale natural_scale(const Model& model);

/// Bounds in SI (degrees where the unit is "deg").
struct EffectBounds {
  double lower = 0, nominal = 0, upper = 0;
};
EffectBounds bounds_of(const EffectParameter& parameter, const NaturalScale& scale);

/// What `*` can stand for in the keys of the row: pairs of materials; for wall_friction, the pairs with a material that
/// only tools and fixed bodies have. Empty if no key of the row has a `*`.
std::vector<std::string> places_of(const EffectRow& row, const Scene& scene);

/// The key of the parameter with `place` in the place of `*`.
std::string key_at(const EffectParameter& parameter, const std::string& place);

/// Path and YAML text of the changes that set the parameters to `values` (one list per parameter, of one number or of
/// its `components`; SI, or degrees), printed so that they read back exactly. Throws Error if the numbers do not fit
/// the row.
std::vector<std::pair<std::string, std::string>> edits(const EffectRow& row,
                                                       std::span<const std::vector<double>> values,
                                                       const std::string& place = "");

}  // namespace repose
