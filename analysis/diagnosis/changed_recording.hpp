#pragma once
/// Recordings that could be made beside those that there are: the same runs, changed in one respect.
#include <optional>
#include <string>
#include <vector>

#include "analysis/diagnosis/fit.hpp"

namespace repose::diagnosis {

/// Of the experiment, in every run that has something of the kind, by `factor`.
struct Change {
  enum class Of {
    nothing,
    speed, spin, height,  ///< of all bodies at the start, free or given; what was put where it lies is not lowered
    mass,                 ///< of the body `name` at the same size (its moments of inertia with it)
    size,                 ///< of the shape `name` and of the bodies that have it, of the same material: masses with the cube. They begin as far above the
                          ///< half-spaces that they touch as before, in units of their size, and spin by as much less as makes a rolling one roll
    setting,              ///< the plain number at the key `name` that the bundle sets for its runs
  } of = Of::nothing;
  double factor = 1;
  std::string name = {};
  std::string words() const;  ///< "start at 4 times the speed"
};

/// All that are tried: every kind by the factors 0.5, 2 and 4 (sizes: 0.5 and 2), masses also by 0.25. What a fit turns is not changed by
/// the experimenter: masses and sizes that `fit` has among its shared parameters are left out. Of more than three bodies the first three.
std::vector<Change> changes_of(const Problem& problem, const Fit& fit);

/// Values of a run that a change sets: keys of its scene, as numbers that no fit turns.
struct SetValues {
  std::vector<Parameter> parameters;
  std::vector<double> values;
};

/// What a change sets in a run that started from the values `own` of `layout`; nothing where the run has nothing of the kind.
SetValues changed(const Problem& problem, const Layout& layout, const Values& own, std::size_t run, const Change& change);

/// The fit with these values in one run. What was not among the run's values stands behind them.
Fit with(Fit fit, std::size_t run, const SetValues& set);

}  // namespace repose::diagnosis
