#include "analysis/diagnosis/bulk_diagnose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/bulk_campaign.hpp"
#include "analysis/diagnosis/bulk_data.hpp"
#include "analysis/diagnosis/bulk_statistics.hpp"
#include "analysis/diagnosis/score.hpp"
#include "analysis/statistics.hpp"
#include "core/error.hpp"
#include "core/yaml_tree.hpp"

namespace repose::diagnosis {
namespace {

/// Chance below which a recording is not suggested, and probability below which a rival asks for none.
constexpr double worth_recording = 0.5, worth_parting = 1e-3;

/// p of the first packings, outside which they decide. Within, the test with more decides alone, so that it rejects a true nominal scene no more often than
/// its own level and `plainly_rejected` together.
constexpr double plainly_rejected = 5e-4, plainly_fits = 0.2;

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<BulkEstimate> estimates_of(const BulkModel& model) {
  std::vector<BulkEstimate> list;
  const VectorXd at = fitted_point(model);
  for (std::size_t i = 0; i < model.candidate.parameters.size(); ++i) {
    const Parameter& p = model.candidate.parameters[i];
    const auto k = static_cast<Index>(i);
    BulkEstimate e{p.component < 0 ? p.key : fmt::format("{}.{}", p.key, p.component), p.unit, p.effect, value_at(p, at[k]), 0, 0};
    e.lower = std::min(e.value, value_at(p, model.posterior.quantile(k, 0.05)));
    e.upper = std::max(e.value, value_at(p, model.posterior.quantile(k, 0.95)));
    list.push_back(e);
  }
  return list;
}

/// What the model leaves on the training or the held-out runs.
BulkScore score_of(const BulkModel& model, const BulkModel& nominal, const BulkData& data, const MatrixXd& scatter, bool held) {
  BulkScore score;
  MatrixXd noise = scatter;
  noise.diagonal() += data.extra;
  const Predict predict = predictor(model, nominal, data, scatter);
  const BulkPrediction emulated = predict(model.posterior.best);
  double chi2 = 0;
  VectorXd squares = VectorXd::Zero(static_cast<Index>(data.summaries.size()));
  for (std::size_t s = 0; s < data.settings.size(); ++s) {
    const MatrixXd simulated = complete_rows(rows_at_fit(model, nominal, data, s));
    const VectorXd expected = simulated.rows() > 0 ? VectorXd(simulated.colwise().mean().transpose()) : emulated.mean[s];
    const MatrixXd& rows = held ? data.settings[s].held : data.settings[s].train;
    const auto& ids = held ? data.settings[s].held_runs : data.settings[s].train_runs;
    for (Index i = 0; i < rows.rows(); ++i) {
      const VectorXd r = rows.row(i).transpose() - expected;
      chi2 += squared_distance(r, noise);
      squares += r.cwiseAbs2();
      score.runs.push_back(ids[static_cast<std::size_t>(i)]);
    }
  }
  if (score.runs.empty()) return score;
  const double n = static_cast<double>(score.runs.size());
  score.chi2_per_dof = chi2 / (n * static_cast<double>(data.summaries.size()));
  for (std::size_t k = 0; k < data.summaries.size(); ++k) score.rmse[data.summaries[k].name] = std::sqrt(squares[static_cast<Index>(k)] / n);
  return score;
}

/// Squared distance of the training means from the model beyond what chance gives, all settings.
double excess(const BulkModel& model, const BulkModel& nominal, const BulkData& data, const MatrixXd& scatter) {
  double sum = 0;
  const BulkPrediction emulated = predictor(model, nominal, data, scatter)(model.posterior.best);
  for (std::size_t s = 0; s < data.settings.size(); ++s) {
    const double n = static_cast<double>(data.settings[s].train.rows());
    if (n == 0 || !emulated.mean[s].allFinite()) continue;
    MatrixXd c = (scatter + MatrixXd(data.extra.asDiagonal())) / n;
    c.diagonal() += emulated.variance[s];
    sum += squared_distance(data.settings[s].train.colwise().mean().transpose() - emulated.mean[s], c) - static_cast<double>(c.rows());
  }
  return std::max(0.0, sum);
}

/// Does the one list hold all of the other?
bool shares_all(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  const auto within = [](const std::vector<std::string>& few, const std::vector<std::string>& many) {
    return std::all_of(few.begin(), few.end(), [&](const std::string& name) { return std::find(many.begin(), many.end(), name) != many.end(); });
  };
  return within(a, b) || within(b, a);
}

std::vector<std::vector<Observation>> recorded(const Bundle& bundle, const std::vector<std::size_t>& runs) {
  std::vector<std::vector<Observation>> result;
  for (const std::size_t i : runs) result.push_back(bundle.runs[i].observations);
  return result;
}

class BulkDiagnosing {
 public:
  BulkDiagnosing(const Bundle& bundle, const SimulateBulk& simulate, const BulkOptions& options)
      : result_{}, bundle_(of_equal_length(bundle, result_.notes)), options_(options), campaign_(bundle_, prepared(), simulate, options_) {}

  BulkDiagnosis run() {
    try {
      campaign_.nominal();
      doubt_units();
      measure_mismatch();
      if (result_.lack_of_fit_p > plainly_rejected && result_.lack_of_fit_p < plainly_fits && options_.doubtful_seeds > 0) {
        campaign_.more_of_nominal();
        measure_mismatch();
      }
      if (result_.lack_of_fit_p <= level) {
        campaign_.screen();
        campaign_.refine();
        campaign_.numerics();
        campaign_.pairs();
      } else {
        result_.notes.push_back(result_.tested_dimensions > 0 ? "The nominal scene was not rejected, so no candidate was simulated."
                                                              : "There are as many free constants as tested numbers: any value is reached, and nothing can be said.");
      }
    } catch (const BulkInterrupted&) {
      result_.interrupted = true;
    }
    finish();
    return std::move(result_);
  }

 private:
  const BulkData& prepared() {
    result_.data = bulk_data(bundle_, options_.seed, result_.notes);
    for (const std::string& warning : bundle_.warnings) result_.notes.push_back(warning);
    if (!bundle_.noise.empty()) result_.notes.push_back("The stated noise was not used: of many grains the scatter between packings is larger and is estimated.");
    if (std::any_of(bundle_.runs.begin(), bundle_.runs.end(), [](const BundleRun& run) { return !run.free.empty(); }))
      result_.notes.push_back("Start values that are `free` were left as in the scene: of many grains none is estimated.");
    return result_.data;
  }

  /// A recording in millimetres or grams is no physics. Sizes and masses are asked; angles have no scale, and what may change its sign has no ratio.
  void doubt_units() {
    const BulkModel& nominal = campaign_.models().front();
    const std::size_t s = result_.data.first_fitted();
    const MatrixXd simulated = complete_rows(rows_at_fit(nominal, nominal, result_.data, s));
    const MatrixXd& recorded = result_.data.settings[s].train;
    if (simulated.rows() == 0 || recorded.rows() == 0) return;
    for (std::size_t k = 0; k < result_.data.summaries.size(); ++k) {
      const BulkSummary& summary = result_.data.summaries[k];
      if (summary.unit != "m" && summary.unit != "kg" && summary.unit != "kg/s") continue;
      const double ours = simulated.col(static_cast<Index>(k)).mean(), theirs = recorded.col(static_cast<Index>(k)).mean();
      const double thousands = std::log10(theirs / ours) / 3;
      if (!std::isfinite(thousands) || std::round(thousands) == 0 || std::abs(thousands - std::round(thousands)) > 0.15) continue;
      result_.notes.push_back(fmt::format("The recorded {} ({:.3g} {}) is {:.2g} times that of the nominal scene. Recordings are in SI units unless `unit` says otherwise: are these "
                                          "millimetres, grams or milligrams? Then this diagnosis says nothing.", summary.name, theirs, summary.unit, theirs / ours));
    }
  }

  void measure_mismatch() {
    const BulkModel& nominal = campaign_.models().front();
    const BulkCampaign::LackOfFit test = campaign_.lack_of_fit(nominal);
    result_.lack_of_fit_p = test.p;
    result_.tested_dimensions = test.dimensions;
    const std::size_t setting = result_.data.first_fitted();
    std::vector<std::vector<Observation>> simulated;
    for (const BulkOutcome& o : outcomes_at_fit(nominal, nominal, result_.data, setting))
      if (o.failure.empty()) simulated.push_back(o.observations);
    result_.where = locate_bulk(recorded(bundle_, result_.data.settings[setting].train_runs), simulated);
    // One number alone: it is located where it was tested.
    if (result_.where.size() == 1) result_.where.front().p = test.p;
  }

  void finish() {
    result_.simulations = campaign_.simulations();
    result_.scatter = campaign_.scatter().covariance;
    result_.scatter_dof = campaign_.scatter().dof;
    if (campaign_.failures() > 0) result_.notes.push_back(fmt::format("{} of {} simulations failed and were left out.", campaign_.failures(), campaign_.simulations()));
    for (const BulkModel& m : campaign_.models())
      if (m.posterior.weight.size() > 0) models_.push_back(&m);
    if (models_.empty()) return;
    judge_models();
    const BulkModel& nominal = *models_.front();
    for (const BulkModel* m : models_)
      result_.models.push_back({*m, estimates_of(*m), score_of(*m, nominal, result_.data, result_.scatter, false), score_of(*m, nominal, result_.data, result_.scatter, true)});
    for (BulkFitted& fitted : result_.models) fitted.model.parts.clear();  // which end with the campaign
    compare_held_out();
    suggest();
    const BulkModel& best = *models_[result_.best];
    // An error of the recording changes nothing in the scene.
    const bool of_scene = best.candidate.kind != BulkCandidate::Kind::recording;
    result_.extended_scene = emit_yaml(bulk_scene(bundle_, campaign_.scale(), of_scene ? best.candidate : nominal.candidate, fitted_point(of_scene ? best : nominal)));
  }

  void judge_models() {
    bool held = false;
    for (const BulkSetting& s : result_.data.settings) held = held || s.held.rows() > 0;
    std::vector<Evidence> evidence;
    const BulkModel& nominal = *models_.front();
    const double before = excess(nominal, nominal, result_.data, result_.scatter);
    std::size_t leading = 0;
    for (std::size_t i = 0; i < models_.size(); ++i) {
      const BulkModel& m = *models_[i];
      Evidence e;
      e.effects = m.candidate.hypothesis.names();
      for (const Term& term : m.candidate.hypothesis.terms) e.sites.push_back(term.row->site);
      e.general = static_cast<int>(std::count_if(m.candidate.hypothesis.terms.begin(), m.candidate.hypothesis.terms.end(), [](const Term& t) { return !t.row->limit.empty(); }));
      // Calibrated constants are the nominal's own.
      for (const Parameter& p : m.candidate.parameters) e.parameters += !p.effect.empty();
      e.held_out = held ? m.posterior.held_log_likelihood : m.posterior.best_log_likelihood;
      if (!std::isfinite(e.held_out)) e.held_out = -1e12;
      e.held_out_as_fitted = e.held_out;
      e.per_run = m.posterior.held_of_run;
      e.stated = stated_in(m.candidate.hypothesis);
      e.train_gain = 2 * (m.posterior.best_log_likelihood - nominal.posterior.best_log_likelihood);
      const BulkCampaign::LackOfFit left = campaign_.lack_of_fit(m);
      e.lack_of_fit = left.p <= level ? std::sqrt(left.ratio) : 1;
      e.form_parameters = e.parameters;
      e.explained = before > 0 ? 1 - excess(m, nominal, result_.data, result_.scatter) / before : 0;
      evidence.push_back(e);
      const auto worth = [&](std::size_t j) { return models_[j]->posterior.best_log_likelihood - static_cast<double>(models_[j]->candidate.parameters.size()); };
      if (worth(i) > worth(leading)) leading = i;
    }
    // What is left over is that of the model which is named; that is first thought to be the likeliest.
    for (int pass = 0; pass < 3; ++pass) {
      if (leading != 0) result_.remaining_p = campaign_.lack_of_fit(*models_[leading]).p;
      result_.verdict = judge(evidence, result_.lack_of_fit_p, result_.remaining_p, held);
      const auto named = static_cast<std::size_t>(result_.verdict.best);
      if (named == 0 || named == leading) break;
      leading = named;
    }
    result_.best = static_cast<std::size_t>(result_.verdict.best);
    if (result_.verdict.by_fitted_runs)
      result_.notes.push_back("The runs that were held out speak for no candidate: these were weighed on the fitted runs as well, and no prediction proves the verdict.");
    result_.explained = evidence[result_.best].explained;
  }

  void compare_held_out() {
    const std::vector<double>& a = models_.front()->posterior.held_of_run;
    const std::vector<double>& b = models_[result_.best]->posterior.held_of_run;
    if (result_.best == 0 || a.size() < 2) return;
    std::vector<double> nominal, extended;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (!std::isfinite(a[i]) || !std::isfinite(b[i])) continue;
      nominal.push_back(a[i]);
      extended.push_back(b[i]);
    }
    const PairedGain gain = paired_gain(nominal, extended);
    result_.paired_p = gain.p;
    result_.effect_size = gain.effect_size;
  }

  /// The best against those it cannot be told from, else against its nearest rival that is no part of it.
  void suggest() {
    if (result_.best == 0) return;
    const BulkModel& best = *models_[result_.best];
    std::vector<int> rivals = result_.verdict.rivals;
    for (const Ranked& r : result_.verdict.ranked)
      if (rivals.empty() && r.model > 0 && r.probability >= worth_parting && static_cast<std::size_t>(r.model) != result_.best && !shares_all(r.effects, best.candidate.hypothesis.names())) rivals = {r.model};
    for (const int rival : rivals) {
      SuggestedRecording s = bulk_recording_that_parts(best, *models_[static_cast<std::size_t>(rival)], *models_.front(), result_.data, bundle_.runs.front().observations);
      if (s.power >= worth_recording)
        result_.suggested.push_back(std::move(s));
      else if (!result_.verdict.rivals.empty())
        result_.notes.push_back(fmt::format("No recording that was thought of would tell {} from {}.", best.candidate.hypothesis.label(), models_[static_cast<std::size_t>(rival)]->candidate.hypothesis.label()));
    }
  }

  BulkDiagnosis result_;
  const Bundle bundle_;
  const BulkOptions options_;
  BulkCampaign campaign_;
  std::vector<const BulkModel*> models_;
};

}  // namespace

bool is_bulk(const Bundle& bundle) {
  return !bundle.scene.grains.empty() && std::any_of(bundle.runs.begin(), bundle.runs.end(), [](const BundleRun& run) { return !summaries_of(run.observations).empty(); });
}

BulkDiagnosis diagnose_bulk(const Bundle& bundle, const SimulateBulk& simulate, const BulkOptions& options) {
  return BulkDiagnosing(bundle, simulate, options).run();
}

}  // namespace repose::diagnosis
