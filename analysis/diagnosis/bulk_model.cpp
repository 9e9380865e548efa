#include "analysis/diagnosis/bulk_model.hpp"

#include <cmath>
#include <limits>
#include <memory>

#include "analysis/diagnosis/bulk_emulator.hpp"

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

/// Coordinates of the nominal's designs in the candidate's cube.
std::vector<std::pair<VectorXd, const DesignPoint*>> designs_of(const BulkModel& model, const BulkModel& nominal) {
  std::vector<std::pair<VectorXd, const DesignPoint*>> all;
  if (&model != &nominal)
    for (const DesignPoint& point : nominal.design) all.emplace_back(null_point(model.candidate, point.at), &point);
  for (const DesignPoint& point : model.design) all.emplace_back(point.at, &point);
  return all;
}

/// One emulator per setting and summary; empty where nothing was measurable.
std::vector<std::vector<std::shared_ptr<const Emulator>>> emulators_of(const BulkModel& model, const BulkModel& nominal, const BulkData& data,
                                                                        const MatrixXd& scatter) {
  const auto designs = designs_of(model, nominal);
  const Index axes = static_cast<Index>(model.candidate.parameters.size());
  std::vector<std::vector<std::shared_ptr<const Emulator>>> emulators(data.settings.size());
  for (std::size_t s = 0; s < data.settings.size(); ++s)
    for (std::size_t k = 0; k < data.summaries.size(); ++k) {
      const auto column = static_cast<Index>(k);
      std::vector<VectorXd> at;
      std::vector<double> value, noise;
      for (const auto& [where, point] : designs) {
        const auto [mean, count] = column_means(point->rows[s]);
        if (!(count[column] > 0)) continue;
        at.push_back(where);
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
      emulators[s].push_back(std::make_shared<const Emulator>(points, VectorXd(Eigen::Map<const VectorXd>(value.data(), n)), VectorXd(Eigen::Map<const VectorXd>(noise.data(), n))));
    }
  return emulators;
}

const DesignPoint* at_fit(const BulkModel& model) {
  return model.direct >= 0 ? &model.design[static_cast<std::size_t>(model.direct)] : nullptr;
}

std::vector<BulkOutcome> disturbed_outcomes(const BulkModel& model, const VectorXd& point, std::vector<BulkOutcome> outcomes) {
  for (BulkOutcome& o : outcomes) o.observations = disturbed(model.candidate, point, std::move(o.observations));
  return outcomes;
}

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

MatrixXd rows_of(const std::vector<BulkOutcome>& outcomes, const std::vector<BulkSummary>& summaries) {
  MatrixXd rows = MatrixXd::Constant(static_cast<Index>(outcomes.size()), static_cast<Index>(summaries.size()), nan);
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    for (std::size_t k = 0; k < summaries.size() && outcomes[i].failure.empty(); ++k)
      rows(static_cast<Index>(i), static_cast<Index>(k)) = value_of(summaries[k], outcomes[i].observations);
  return rows;
}

Predict predictor(const BulkModel& model, const BulkModel& nominal, const BulkData& data, const MatrixXd& scatter) {
  if (model.candidate.kind == BulkCandidate::Kind::recording)
    return [&model, &nominal, &data, scatter](const VectorXd& point) {
      std::vector<MatrixXd> rows;
      for (std::size_t s = 0; s < data.settings.size(); ++s)
        rows.push_back(rows_of(disturbed_outcomes(model, point, outcomes_at_fit(nominal, nominal, s)), data.summaries));
      return of_means(rows, scatter);
    };
  if (model.candidate.parameters.empty()) {
    const BulkPrediction fixed = of_means(model.design.front().rows, scatter);
    return [fixed](const VectorXd&) { return fixed; };
  }
  const auto emulators = emulators_of(model, nominal, data, scatter);
  return [emulators](const VectorXd& point) {
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

std::vector<BulkOutcome> outcomes_at_fit(const BulkModel& model, const BulkModel& nominal, std::size_t setting) {
  if (model.candidate.kind == BulkCandidate::Kind::recording)
    return disturbed_outcomes(model, model.posterior.best, outcomes_at_fit(nominal, nominal, setting));
  const DesignPoint* point = at_fit(model);
  return point == nullptr ? std::vector<BulkOutcome>{} : point->outcomes[setting];
}

MatrixXd rows_at_fit(const BulkModel& model, const BulkModel& nominal, const BulkData& data, std::size_t setting) {
  return rows_of(outcomes_at_fit(model, nominal, setting), data.summaries);
}

}  // namespace repose::diagnosis
