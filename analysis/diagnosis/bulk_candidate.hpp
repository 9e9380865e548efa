#pragma once
/// What may be missing from a scene of many grains, and the unit cube in which its coefficients are searched.
///
/// Coordinate u in [0, 1] of a coefficient between its bounds a < b:
///   logarithmic   ln v = ln a + u (ln b - ln a)
///   one-sided     v = a + u^2 (b - a)    where a does nothing: small coefficients matter most
///   else          v = a + u (b - a)
/// What does nothing lies at the nearest end of a logarithmic axis (no cohesion at u = 0).
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analysis/diagnosis/hypothesis.hpp"

namespace repose::diagnosis {

struct BulkCandidate {
  enum class Kind {
    simulated,  ///< asks for simulations of its own; beside physics it may hold an error of the recording, made on what they give
    recording,  ///< errors of the recording alone, made on what the nominal scene gave
    numerics,   ///< the nominal scene solved otherwise: at a quarter of the step, to a tenth of the tolerance, or by another engine, as the term says
  } kind = Kind::simulated;
  Hypothesis hypothesis;               ///< none: the nominal scene
  std::vector<Parameter> parameters;   ///< axes of the cube: calibrated constants, those of the terms in the scene, those of the recording
  std::vector<Override> calibrated;    ///< numerics: the constants as the nominal scene was fitted
  std::string backend;                 ///< numerics: the engine that solves it; empty: the own one
};

double value_at(const Parameter& parameter, double u);
double coordinate_of(const Parameter& parameter, double value);

/// Where the terms of the candidate do nothing, with the calibrated constants at `calibrated`.
Eigen::VectorXd null_point(const BulkCandidate& candidate, const Eigen::VectorXd& calibrated);

/// The nominal scene, with its calibrated constants as axes.
BulkCandidate nominal_candidate(const Bundle& bundle, const NaturalScale& scale);

/// Two candidates as one. Neither may be numerics.
BulkCandidate together(const BulkCandidate& a, const BulkCandidate& b);

/// Where a parameter of another candidate lies among this one's axes; -1: nowhere.
Eigen::Index axis_of(const BulkCandidate& candidate, const Parameter& parameter);

/// The axes that a simulation knows: all but those of the recording, which come last.
Eigen::Index scene_axes(const BulkCandidate& candidate);

/// The axes are cut to where the scene can be built.
///
/// Candidates in the order in which they are tried: laws of grains on grains and of the population, the air, walls, where the scene lacks them; values of
/// the first kinds that it states and that may be wrong (two among grains and the friction of two walls, if none are named); then errors of the recording. `wanted`: names of effects; empty: those of `bulk_effects` that fit, at most `most` simulated ones. Throws Error for
/// a name that the library lacks or that the scene cannot take.
std::vector<BulkCandidate> bulk_candidates(const Bundle& bundle, const NaturalScale& scale, const std::vector<std::string>& wanted, std::size_t most);

/// Names tried if none are asked for, the likeliest first.
const std::vector<std::string>& bulk_effects();

/// The keys that the axes set in the scene at a point of the cube.
std::vector<Override> values_at(const BulkCandidate& candidate, const Eigen::VectorXd& point);

/// The scene of the candidate at a point of its cube, with the keys of one setting.
YamlNode bulk_scene(const Bundle& bundle, const NaturalScale& scale, const BulkCandidate& candidate, const Eigen::VectorXd& point,
                    const std::vector<Override>& set = {});

/// `count` points that fill the cube: the middles of equal parts of one axis, Sobol's sequence for more. One row each.
Eigen::MatrixXd space_filling(int count, Eigen::Index axes);

}  // namespace repose::diagnosis
