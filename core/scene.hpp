#pragma once
/// The scene: what a user wrote, checked and in SI units, before any grain is made. Pure data; knows no engine.
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/effect.hpp"
#include "core/fill.hpp"
#include "core/material.hpp"
#include "core/layer_setup.hpp"
#include "core/model.hpp"
#include "core/population.hpp"
#include "core/tool.hpp"
#include "core/world.hpp"

namespace repose {

struct SceneBody {
  std::string name;
  std::string shape;     ///< key of Scene::shapes
  std::string material;
  Vec3 position = Vec3::Zero();          ///< of the shape's own origin [m]
  Quat orientation = Quat::Identity();   ///< of the shape's own frame
  Vec3 velocity = Vec3::Zero();          ///< of the shape's own origin [m/s]
  Vec3 angular_velocity = Vec3::Zero();  ///< [rad/s], world frame
  bool fixed = false;
  std::optional<double> mass;            ///< [kg]; else density * volume
  std::optional<Vec3> inertia;           ///< principal moments [kg m^2], axes of the shape's own frame
  std::optional<Motion> motion;          ///< prescribed; the body is then not dynamic
};

struct GrainPopulation {
  std::string name;
  std::string material;
  std::optional<std::size_t> count;      ///< exactly one of count and mass is given
  std::optional<double> total_mass;      ///< [kg]
  std::map<std::string, double> mix;     ///< grain shape name -> share
  bool mix_by_mass = false;
  double aspect = 1;                     ///< GrainProportions::with_aspect
  SizeDistribution size;
  FillRegion fill;
  Vec3 velocity = Vec3::Zero();          ///< at the start [m/s]
};

struct Scene {
  std::map<std::string, Material> materials;
  std::map<std::pair<std::string, std::string>, PairLaw> pairs;  ///< keys in alphabetical order
  std::map<std::string, Shape> shapes;
  std::vector<SceneBody> bodies;          ///< sorted by name
  std::vector<GrainPopulation> grains;    ///< sorted by name
  std::vector<Tool> tools;                ///< sorted by name
  std::optional<LayerSetup> layer;        ///< what `repose layer` does with it
  GrainProportions proportions;
  Vec3 gravity{0, 0, -9.81};
  PeriodicCell periodic;                  ///< along x, y or both; see periodic_body.hpp
  std::vector<Effect> effects;
  std::vector<ContactEffect> contact_effects;
  Vec3 inertia_factor = Vec3::Ones();          ///< InertiaFactor (setup_effects.hpp)
  Vec3 center_of_mass_offset = Vec3::Zero();  ///< CenterOfMassOffset [m]
  SolverOptions solver;
  double duration = 0;                    ///< [s], > 0
  double frame_interval = 0;              ///< between recorded frames [s], > 0
  std::string text;                       ///< the resolved scene as YAML (overrides applied): what was understood
};

/// Makes every grain: the model that a backend simulates. The same scene and seed give the same model on every backend.
/// Pairs of materials that the scene does not name, but whose bodies can meet, are an Error.
Model realise(const Scene& scene, std::uint64_t seed);

}  // namespace repose
