#pragma once
/// A settled bed and its spreader as input of LAMMPS (atom_style sphere, pair_style granular).
///
/// Contact law: Hertz with the damping of Tsuji, linear history friction, rolling and twisting resistance as bounded
/// spring-dashpot-sliders (Luding 2008; LAMMPS: `rolling sds`, `twisting sds`). Rolling: |tau| <= rho R* f_n, as here; twisting
/// is bounded by a length there, for which sigma times the R* of two mean grains is taken (of a mean grain and a wall: twice that).
#include <filesystem>

#include "core/scene.hpp"
#include "scenarios/spreading.hpp"

namespace repose {

struct LammpsSettings {
  double young = 0;       ///< of grains and walls [Pa]; soft, so that steps can be long
  double time_step = 0;   ///< [s]
  double settle = 0;      ///< time in which the bed takes the softness up, before the spreader starts [s]
  std::filesystem::path folder;  ///< of bed.data, settle.in and spread.in, which write settled.dump, spread.dump and overlap.txt
};

/// Throws Error for what such input cannot say: grains that are not spheres, tools other than plates and a roller, sides that
/// are not periodic along y.
void write_lammps_input(const Scene& scene, const Spreading& spreading, const LammpsSettings& settings);

/// The largest step that is advised [s]: `share` of the Rayleigh time of the smallest grain.
double rayleigh_step(const Model& model, double young, double share);

}  // namespace repose
