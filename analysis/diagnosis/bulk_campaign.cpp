#include "analysis/diagnosis/bulk_campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/bulk_sampling.hpp"
#include "core/error.hpp"
#include "core/yaml_tree.hpp"

namespace repose::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::uint64_t seeds_apart = 1'000'000;  // simulated packings are never those of a recording made with small seeds
constexpr double resolution = 1e-6;               // of a summary, as a share of its value
constexpr double moved = 0.5;                     // standard deviations of the posterior: then the fit is simulated once more

MatrixXd columns(const MatrixXd& rows, const std::vector<Index>& chosen) {
  MatrixXd result(rows.rows(), static_cast<Index>(chosen.size()));
  for (std::size_t k = 0; k < chosen.size(); ++k) result.col(static_cast<Index>(k)) = rows.col(chosen[k]);
  return result;
}

}  // namespace

BulkCampaign::BulkCampaign(const Bundle& bundle, const BulkData& data, const SimulateBulk& simulate, const BulkOptions& options)
    : bundle_(bundle), data_(data), run_(simulate), options_(options), scale_(natural_scale(realise(bundle.scene, 1))), next_seed_(options.seed * seeds_apart) {
  models_.emplace_back();
  models_.front().candidate = nominal_candidate(bundle, scale_);
}

void BulkCampaign::simulate(const std::string& stage, const std::vector<Wanted>& wanted) {
  std::vector<BulkRequest> requests;
  for (const Wanted& w : wanted)
    for (int i = 0; i < w.seeds; ++i) {
      ++next_seed_;
      for (const BulkSetting& setting : data_.settings)
        requests.push_back({emit_yaml(bulk_scene(bundle_, scale_, w.model->candidate, w.at, setting.set)), next_seed_});
    }
  const auto answers = run_(stage, requests);
  if (!answers) throw BulkInterrupted{};
  simulations_ += requests.size();
  auto answer = answers->begin();
  demand_nominal(stage, wanted, *answers);
  for (const Wanted& w : wanted) {
    DesignPoint point;
    point.at = w.at;
    point.outcomes.resize(data_.settings.size());
    for (int i = 0; i < w.seeds; ++i)
      for (std::size_t s = 0; s < data_.settings.size(); ++s) {
        const BulkSetting& setting = data_.settings[s];
        const std::size_t like = setting.train_runs.empty() ? setting.held_runs.front() : setting.train_runs.front();
        BulkOutcome outcome = *answer++;
        failures_ += !outcome.failure.empty();
        outcome.observations = sampled_like(std::move(outcome.observations), bundle_.runs[like].observations);
        point.outcomes[s].push_back(std::move(outcome));
      }
    for (const auto& outcomes : point.outcomes) point.rows.push_back(rows_of(outcomes, data_.summaries));
    w.model->design.push_back(std::move(point));
  }
}

/// A tried value may fail; a nominal scene that fails with every seed cannot be diagnosed, and its first failure says why.
void BulkCampaign::demand_nominal(const std::string& stage, const std::vector<Wanted>& wanted, const std::vector<BulkOutcome>& answers) const {
  const std::string* failure = nullptr;
  std::size_t at = 0;
  for (const Wanted& w : wanted)
    for (std::size_t i = 0; i < static_cast<std::size_t>(w.seeds) * data_.settings.size(); ++i, ++at) {
      if (w.model != &models_.front()) continue;
      if (answers[at].failure.empty()) return;
      failure = failure == nullptr ? &answers[at].failure : failure;
    }
  if (failure != nullptr)
    throw Error("diagnose", fmt::format("{}: every simulation failed, the first one so: {}", stage, *failure), "mend the bundle's scene, or what its runs set",
                Error::Kind::simulation);
}

/// Scatter about the mean: of the recorded runs, the nominal ones and those of each fitted candidate. Far from them it may be another.
void BulkCampaign::find_scatter() {
  std::vector<MatrixXd> samples;
  for (const BulkSetting& s : data_.settings) samples.push_back(s.train);
  for (const BulkModel& model : models_)
    for (std::size_t i = 0; i < model.design.size(); ++i)
      if (&model == &models_.front() || static_cast<int>(i) == model.direct)
        for (const MatrixXd& rows : model.design[i].rows) samples.push_back(rows);
  scatter_ = shrunken_scatter(samples);
  // A number that never varies (all that was poured in came out) is known to the resolution of a record, not exactly.
  for (Index k = 0; k < scatter_.covariance.rows(); ++k) {
    double largest = 0;
    for (const MatrixXd& rows : samples)
      for (Index i = 0; i < rows.rows(); ++i)
        if (std::isfinite(rows(i, k))) largest = std::max(largest, std::abs(rows(i, k)));
    scatter_.covariance(k, k) = std::max(scatter_.covariance(k, k), std::pow(resolution * largest, 2));
  }
  if (scatter_.dof < 1)
    throw Error("diagnose", "no simulation of the nominal scene gave what was recorded", "simulate it: `repose aor` for a heap, `repose layer` for a layer", Error::Kind::simulation);
}

void BulkCampaign::fit(BulkModel& model) {
  model.posterior = posterior_of(data_, predictor(model, models_.front(), data_, scatter_.covariance), scatter_.covariance,
                                 static_cast<Index>(model.candidate.parameters.size()));
  model.fitted_designs = model.design.size();
}

void BulkCampaign::simulate_fit(const std::string& stage, const std::vector<BulkModel*>& models, int seeds) {
  std::vector<Wanted> wanted;
  for (BulkModel* model : models) {
    if (model->direct >= 0) {
      const VectorXd& at = model->design[static_cast<std::size_t>(model->direct)].at;
      bool far = false;
      for (Index k = 0; k < at.size(); ++k) far = far || std::abs(at[k] - model->posterior.best[k]) > moved * model->posterior.sd(k);
      if (!far) continue;
    }
    model->direct = static_cast<int>(model->design.size());
    wanted.push_back({model, model->posterior.best, seeds});
  }
  if (wanted.empty()) return;
  try {
    simulate(stage, wanted);
  } catch (const BulkInterrupted&) {
    for (const Wanted& w : wanted) w.model->direct = -1;
    throw;
  }
  find_scatter();
  for (BulkModel& model : models_)
    if (!model.design.empty() || model.candidate.kind == BulkCandidate::Kind::recording) fit(model);
}

void BulkCampaign::nominal() {
  BulkModel& model = models_.front();
  const auto axes = static_cast<Index>(model.candidate.parameters.size());
  if (axes == 0) {
    simulate("the nominal scene", {{&model, VectorXd(0), options_.nominal_seeds}});
    model.direct = 0;
    find_scatter();
    fit(model);
    return;
  }
  std::vector<Wanted> wanted;
  const MatrixXd points = space_filling(options_.levels * static_cast<int>(axes), axes);
  for (Index i = 0; i < points.rows(); ++i) wanted.push_back({&model, points.row(i).transpose(), options_.level_seeds});
  simulate("calibrating the nominal scene", wanted);
  find_scatter();
  fit(model);
  for (int round = 0; round < 2; ++round) simulate_fit("calibrating the nominal scene", {&model}, options_.nominal_seeds);
}

void BulkCampaign::more_of_nominal() {
  BulkModel& model = models_.front();
  simulate("more of the nominal scene", {{&model, model.design[static_cast<std::size_t>(model.direct)].at, options_.doubtful_seeds}});
  const DesignPoint more = std::move(model.design.back());
  model.design.pop_back();
  DesignPoint& point = model.design[static_cast<std::size_t>(model.direct)];
  for (std::size_t s = 0; s < more.rows.size(); ++s) {
    point.outcomes[s].insert(point.outcomes[s].end(), more.outcomes[s].begin(), more.outcomes[s].end());
    MatrixXd rows(point.rows[s].rows() + more.rows[s].rows(), more.rows[s].cols());
    rows << point.rows[s], more.rows[s];
    point.rows[s] = std::move(rows);
  }
  find_scatter();
  fit(model);
}

void BulkCampaign::screen() {
  for (BulkCandidate& c : bulk_candidates(bundle_, scale_, options_.effects, static_cast<std::size_t>(options_.most_candidates))) {
    models_.emplace_back();
    models_.back().candidate = std::move(c);
  }
  std::vector<Wanted> wanted;
  for (BulkModel& model : models_) {
    if (&model == &models_.front() || model.candidate.kind != BulkCandidate::Kind::simulated) continue;
    const auto axes = static_cast<Index>(model.candidate.parameters.size());
    const MatrixXd points = space_filling(options_.levels * static_cast<int>(axes), axes);
    for (Index i = 0; i < points.rows(); ++i) wanted.push_back({&model, points.row(i).transpose(), options_.level_seeds});
  }
  simulate("screening candidates", wanted);
  for (BulkModel& model : models_)
    if (&model != &models_.front()) fit(model);
}

std::vector<BulkModel*> BulkCampaign::best_few() {
  std::vector<BulkModel*> list;
  for (BulkModel& model : models_)
    if (&model != &models_.front() && model.candidate.kind == BulkCandidate::Kind::simulated) list.push_back(&model);
  const auto worth = [](const BulkModel* m) { return m->posterior.best_log_likelihood - cost_of_parameter * static_cast<double>(m->candidate.parameters.size()); };
  std::stable_sort(list.begin(), list.end(), [&](const BulkModel* a, const BulkModel* b) { return worth(a) > worth(b); });
  if (list.size() > static_cast<std::size_t>(options_.refined)) list.resize(static_cast<std::size_t>(options_.refined));
  return list;
}

void BulkCampaign::refine() {
  const std::vector<BulkModel*> few = best_few();
  std::vector<Wanted> wanted;
  for (BulkModel* model : few) {
    const MatrixXd points = model->posterior.representatives(options_.refined_points);
    for (Index i = 0; i < points.rows(); ++i) wanted.push_back({model, points.row(i).transpose(), options_.refined_seeds});
  }
  if (wanted.empty()) return;
  simulate("looking closer at the best", wanted);
  for (BulkModel* model : few) fit(*model);
  for (int round = 0; round < 2; ++round) simulate_fit("simulating the best directly", best_few(), options_.direct_seeds);
}

void BulkCampaign::numerics() {
  if (options_.numerics_seeds < 1) return;
  models_.emplace_back();
  BulkModel& model = models_.back();
  model.candidate.kind = BulkCandidate::Kind::numerics;
  model.candidate.hypothesis.terms = {{find_effect("time_step"), ""}};
  const BulkModel& nominal = models_.front();
  model.candidate.calibrated = values_at(nominal.candidate, nominal.design[static_cast<std::size_t>(nominal.direct)].at);
  try {
    simulate("a finer step", {{&model, VectorXd(0), options_.numerics_seeds}});
  } catch (const BulkInterrupted&) {
    models_.pop_back();
    throw;
  }
  model.direct = 0;
  fit(model);
}

BulkCampaign::LackOfFit BulkCampaign::lack_of_fit(const BulkModel& model) const {
  LackOfFit result;
  std::vector<double> p;
  int spent = static_cast<int>(model.candidate.parameters.size());
  VectorXd extra(static_cast<Index>(data_.tested.size()));
  for (std::size_t k = 0; k < data_.tested.size(); ++k) extra[static_cast<Index>(k)] = data_.extra[data_.tested[k]];
  for (std::size_t s = 0; s < data_.settings.size(); ++s) {
    const MatrixXd simulated = columns(rows_at_fit(model, models_.front(), data_, s), data_.tested);
    const int here = std::min(spent, static_cast<int>(data_.tested.size()));
    spent -= here;
    const MeanTest test = same_mean(columns(data_.settings[s].train, data_.tested), simulated, extra, here);
    if (test.dimensions == 0) continue;
    p.push_back(test.p);
    result.dimensions += test.dimensions;
    const double rows = test.dof + test.dimensions - 1;
    result.ratio = std::max(result.ratio, test.statistic * test.dof / (rows * test.dimensions));
  }
  result.p = combined_p(p);
  return result;
}

}  // namespace repose::diagnosis
