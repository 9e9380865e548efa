#include "analysis/diagnosis/bulk_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "analysis/diagnosis/bulk_emulator.hpp"
#include "analysis/diagnosis/bulk_recording_error.hpp"
#include "analysis/diagnosis/bulk_sampling.hpp"

namespace repose::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Means of the finite entries of each column, and how many there are.
std::pair<VectorXd, VectorXd> column_means(const MatrixXd& rows) {
  VectorXd mean = VectorXd::Constant(rows.cols(), nan), count = VectorXd::Zero(rows.cols());
  for (Index k = 0; k < rows.cols(); ++k) {
    double sum = 0;
    for (Index i = 0; i < rows.rows(); ++i)
      if (std::isfinite(rows(i, k))) {
        sum += rows(i, k);
        ++count[k];
      }
    if (count[k] > 0) mean[k] = sum / count[k];
  }
  return {mean, count};
}

/// A point of one cube in that of another: axes that it lacks lie at `elsewhere`.
VectorXd carried_over(const BulkCandidate& from, const VectorXd& point, const BulkCandidate& to, VectorXd elsewhere) {
  for (std::size_t i = 0; i < from.parameters.size(); ++i)
    if (const Index axis = axis_of(to, from.parameters[i]); axis >= 0) elsewhere[axis] = point[static_cast<Index>(i)];
  return elsewhere;
}

/// What was simulated for it, for the nominal scene and for its parts, as points of the candidate's cube.
std::vector<std::pair<VectorXd, const DesignPoint*>> designs_of(const BulkModel& model, const BulkModel& nominal) {
  std::vector<std::pair<VectorXd, const DesignPoint*>> all;
  const auto add_others = [&](const BulkModel& other) {
    for (const DesignPoint& point : other.design)
      all.emplace_back(carried_over(other.candidate, point.at, model.candidate, null_point(model.candidate, VectorXd(0))), &point);
  };
  if (&model != &nominal) add_others(nominal);
  for (const BulkModel* part : model.parts) add_others(*part);
  for (const DesignPoint& point : model.design) all.emplace_back(point.at, &point);
  return all;
}

/// Calibrated constants are one group, each effect another.
std::vector<int> groups_of(const BulkCandidate& candidate, Index axes) {
  std::vector<std::string> names;
  std::vector<int> groups;
  for (Index k = 0; k < axes; ++k) {
    const Parameter& p = candidate.parameters[static_cast<std::size_t>(k)];
    const std::string name = p.effect.empty() ? p.effect : p.effect + p.key.substr(0, p.key.rfind('.'));
    const auto known = std::find(names.begin(), names.end(), name);
    groups.push_back(static_cast<int>(known - names.begin()));
    if (known == names.end()) names.push_back(name);
  }
  return candidate.hypothesis.terms.size() > 1 ? groups : std::vector<int>{};
}

/// One emulator per setting and summary; empty where nothing was measurable.
std::vector<std::vector<std::shared_ptr<const Emulator>>> emulators_of(const BulkModel& model, const BulkModel& nominal, const BulkData& data,
                                                                        const MatrixXd& scatter) {
  const auto designs = designs_of(model, nominal);
  const Index axes = scene_axes(model.candidate);
  const std::vector<int> groups = groups_of(model.candidate, axes);
  std::vector<std::vector<std::shared_ptr<const Emulator>>> emulators(data.settings.size());
  for (std::size_t s = 0; s < data.settings.size(); ++s)
    for (std::size_t k = 0; k < data.summaries.size(); ++k) {
      const auto column = static_cast<Index>(k);
      std::vector<VectorXd> at;
      std::vector<double> value, noise;
      for (const auto& [where, point] : designs) {
        const auto [mean, count] = column_means(point->rows[s]);
        if (!(count[column] > 0)) continue;
        at.push_back(where.head(axes));
        value.push_back(mean[column]);
        noise.push_back(std::max(scatter(column, column), 1e-24 * mean[column] * mean[column] + 1e-300) / count[column]);
      }
      if (at.size() < 2) {
        emulators[s].push_back(nullptr);
        continue;
      }
      MatrixXd points(static_cast<Index>(at.size()), axes);
      for (std::size_t i = 0; i < at.size(); ++i) points.row(static_cast<Index>(i)) = at[i].transpose();
      const auto n = static_cast<Index>(value.size());
      emulators[s].push_back(std::make_shared<const Emulator>(points, VectorXd(Eigen::Map<const VectorXd>(value.data(), n)), VectorXd(Eigen::Map<const VectorXd>(noise.data(), n)), groups));
    }
  return emulators;
}

const DesignPoint* at_fit(const BulkModel& model) {
  return model.direct >= 0 ? &model.design[static_cast<std::size_t>(model.direct)] : nullptr;
}

/// First the error, then the recording's times and places: a clock that is late ends with the recording, and a ruler is laid against the whole heap.
std::vector<BulkOutcome> disturbed_outcomes(const BulkCandidate& candidate, const VectorXd& point, std::vector<BulkOutcome> outcomes, const BulkSetting& setting) {
  for (BulkOutcome& o : outcomes) o.observations = disturbed(candidate, point, std::move(o.observations));
  return as_recorded(std::move(outcomes), setting);
}

/// The nearest that was simulated to what the model says: at its fit, else at that of a part, else the nominal scene. Free of errors of the recording.
const DesignPoint* nearest_simulated(const BulkModel& model, const BulkModel& nominal) {
  if (const DesignPoint* own = at_fit(model)) return own;
  for (const BulkModel* part : model.parts)
    if (const DesignPoint* of_part = at_fit(*part)) return of_part;
  return at_fit(nominal);
}

/// By how much an error of the recording moves each summary, tabulated along its axis.
class ErrorMade {
 public:
  ErrorMade(const BulkModel& model, const BulkModel& nominal, const BulkData& data, Index axis) : axis_(axis) {
    const DesignPoint* simulated = nearest_simulated(model, nominal);
    VectorXd point = null_point(model.candidate, VectorXd(0));
    for (std::size_t s = 0; s < data.settings.size(); ++s) {
      const VectorXd plain = simulated == nullptr ? VectorXd() : column_means(simulated->rows[s]).first;
      MatrixXd table = MatrixXd::Constant(static_cast<Index>(data.summaries.size()), cells + 1, nan);
      for (Index i = 0; i <= cells && simulated != nullptr; ++i) {
        point[axis] = static_cast<double>(i) / cells;
        table.col(i) = column_means(rows_of(disturbed_outcomes(model.candidate, point, simulated->outcomes[s], data.settings[s]), data.summaries)).first - plain;
      }
      tables_.push_back(std::move(table));
    }
  }
  VectorXd at(std::size_t setting, const VectorXd& point) const {
    const double x = std::clamp(point[axis_], 0.0, 1.0) * cells;
    const Index i = std::min(static_cast<Index>(x), cells - 1);
    const double share = x - static_cast<double>(i);
    const MatrixXd& table = tables_[setting];
    return (1 - share) * table.col(i) + share * table.col(i + 1);
  }

 private:
  static constexpr Index cells = 128;  // of the range: what is between them is a line to a thousandth of the whole effect
  Index axis_;
  std::vector<MatrixXd> tables_;
};

BulkPrediction of_means(const std::vector<MatrixXd>& rows, const MatrixXd& scatter) {
  BulkPrediction p;
  for (const MatrixXd& r : rows) {
    const auto [mean, count] = column_means(r);
    p.mean.push_back(mean);
    p.variance.push_back(scatter.diagonal().cwiseQuotient(count.cwiseMax(1)));
  }
  return p;
}

}  // namespace

std::vector<BulkOutcome> as_recorded(std::vector<BulkOutcome> outcomes, const BulkSetting& setting) {
  for (BulkOutcome& o : outcomes) o.observations = sampled_like(std::move(o.observations), setting.like);
  return outcomes;
}

MatrixXd rows_of(const std::vector<BulkOutcome>& outcomes, const std::vector<BulkSummary>& summaries) {
  MatrixXd rows = MatrixXd::Constant(static_cast<Index>(outcomes.size()), static_cast<Index>(summaries.size()), nan);
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    for (std::size_t k = 0; k < summaries.size() && outcomes[i].failure.empty(); ++k)
      rows(static_cast<Index>(i), static_cast<Index>(k)) = value_of(summaries[k], outcomes[i].observations);
  return rows;
}

VectorXd fitted_point(const BulkModel& model) {
  VectorXd point = model.posterior.best;
  if (const DesignPoint* simulated = at_fit(model)) point.head(scene_axes(model.candidate)) = simulated->at.head(scene_axes(model.candidate));
  point.tail(model.error_at_fit.size()) = model.error_at_fit;
  return point;
}

namespace {

/// Without errors of the recording.
Predict of_the_scene(const BulkModel& model, const BulkModel& nominal, const BulkData& data, const MatrixXd& scatter) {
  if (model.candidate.kind == BulkCandidate::Kind::recording || scene_axes(model.candidate) == 0) {
    const DesignPoint& simulated = model.candidate.kind == BulkCandidate::Kind::recording ? *at_fit(nominal) : model.design.front();
    return [fixed = of_means(simulated.rows, scatter)](const VectorXd&) { return fixed; };
  }
  return [emulators = emulators_of(model, nominal, data, scatter)](const VectorXd& point) {
    BulkPrediction p;
    for (const auto& of_setting : emulators) {
      const auto n = static_cast<Index>(of_setting.size());
      VectorXd mean = VectorXd::Constant(n, nan), variance = VectorXd::Zero(n);
      for (Index k = 0; k < n; ++k)
        if (const auto& emulator = of_setting[static_cast<std::size_t>(k)]) {
          const Emulator::Prediction at = emulator->at(point);
          mean[k] = at.mean;
          variance[k] = at.variance;
        }
      p.mean.push_back(mean);
      p.variance.push_back(variance);
    }
    return p;
  };
}

}  // namespace

Predict predictor(const BulkModel& model, const BulkModel& nominal, const BulkData& data, const MatrixXd& scatter) {
  const Index known = scene_axes(model.candidate);
  std::vector<ErrorMade> errors;
  for (auto axis = known; axis < static_cast<Index>(model.candidate.parameters.size()); ++axis) errors.emplace_back(model, nominal, data, axis);
  return [known, scene = of_the_scene(model, nominal, data, scatter), errors = std::move(errors)](const VectorXd& point) {
    BulkPrediction p = scene(point.head(known));
    for (const ErrorMade& error : errors)
      for (std::size_t s = 0; s < p.mean.size(); ++s) p.mean[s] += error.at(s, point);
    return p;
  };
}

Predict superposed(const BulkCandidate& pair, const Predicted& a, const Predicted& b, const Predicted& nominal) {
  const auto of_recording = [](const Predicted& p) { return p.model->candidate.kind == BulkCandidate::Kind::recording; };
  const bool first_simulated = !of_recording(a), second_simulated = !of_recording(b);
  // An error of the recording was made on the nominal scene as it was fitted, whatever its constants are elsewhere.
  const bool as_fitted = !first_simulated || !second_simulated;
  const VectorXd fitted = fitted_point(*nominal.model);
  const auto at = [&pair](const Predicted& p, const VectorXd& point, const VectorXd& elsewhere) {
    return p.predict(carried_over(pair, point, p.model->candidate, elsewhere));
  };
  const VectorXd beside_first = null_point(a.model->candidate, VectorXd(0)), beside_second = null_point(b.model->candidate, VectorXd(0));
  return [=](const VectorXd& point) {
    BulkPrediction sum = at(a, point, beside_first);
    const BulkPrediction more = at(b, point, beside_second), less = as_fitted ? nominal.predict(fitted) : at(nominal, point, fitted);
    for (std::size_t s = 0; s < sum.mean.size(); ++s) {
      sum.mean[s] += more.mean[s] - less.mean[s];
      if (second_simulated) sum.variance[s] = first_simulated ? VectorXd(sum.variance[s] + more.variance[s]) : more.variance[s];
    }
    return sum;
  };
}

std::vector<BulkOutcome> outcomes_at_fit(const BulkModel& model, const BulkModel& nominal, const BulkData& data, std::size_t setting) {
  const DesignPoint* point = model.candidate.kind == BulkCandidate::Kind::recording ? at_fit(nominal) : at_fit(model);
  return point == nullptr ? std::vector<BulkOutcome>{} : disturbed_outcomes(model.candidate, fitted_point(model), point->outcomes[setting], data.settings[setting]);
}

MatrixXd rows_at_fit(const BulkModel& model, const BulkModel& nominal, const BulkData& data, std::size_t setting) {
  return rows_of(outcomes_at_fit(model, nominal, data, setting), data.summaries);
}

}  // namespace repose::diagnosis
