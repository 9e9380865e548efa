#include "analysis/diagnosis/bulk_campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
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
constexpr double least_gain_of_pair = 4;          // nats, beyond what its parameters cost, that two effects must be foreseen to gain over the best one
constexpr double near_the_best = 10;              // nats: numerics that come so close are simulated as often as the best candidates
constexpr int glance = 512, look = 4096;          // points of a square, to foresee a pair
constexpr std::size_t looked_at = 8;              // pairs, after a glance

/// As many more as a cube of so many axes needs to be filled half as densely along each.
int filling(int square, Index axes) {
  constexpr Index densest = 4;
  return square << std::clamp<Index>(axes - 2, 0, densest);
}

/// Seed 0 times anything would give the packings 1, 2, ..., of which recordings are made: it has those of a seed that hardly anybody chooses.
std::uint64_t before_first_packing(std::uint64_t seed) { return (seed == 0 ? seeds_apart : seed) * seeds_apart; }

bool is_simulated(const BulkModel& model) { return model.candidate.kind == BulkCandidate::Kind::simulated; }

MatrixXd columns(const MatrixXd& rows, const std::vector<Index>& chosen) {
  MatrixXd result(rows.rows(), static_cast<Index>(chosen.size()));
  for (std::size_t k = 0; k < chosen.size(); ++k) result.col(static_cast<Index>(k)) = rows.col(chosen[k]);
  return result;
}

}  // namespace

BulkCampaign::BulkCampaign(const Bundle& bundle, const BulkData& data, const SimulateBulk& simulate, const BulkOptions& options)
    : bundle_(bundle), data_(data), run_(simulate), options_(options), scale_(natural_scale(realise(bundle.scene, 1))), next_seed_(before_first_packing(options.seed)) {
  models_.emplace_back();
  models_.front().candidate = nominal_candidate(bundle, scale_);
  // What is asked for in vain is told before anything is simulated.
  if (!options.effects.empty()) bulk_candidates(bundle, scale_, options.effects, options.effects.size());
}

void BulkCampaign::simulate(const std::string& stage, const std::vector<Wanted>& wanted) {
  std::vector<BulkRequest> requests;
  for (const Wanted& w : wanted)
    for (int i = 0; i < w.seeds; ++i) {
      ++next_seed_;
      for (const BulkSetting& setting : data_.settings)
        requests.push_back({emit_yaml(bulk_scene(bundle_, scale_, w.model->candidate, w.at, setting.set)), next_seed_, w.model->candidate.backend});
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
        BulkOutcome outcome = *answer++;
        failures_ += !outcome.failure.empty();
        outcome.observations = thinned_like(std::move(outcome.observations), data_.settings[s].like);
        point.outcomes[s].push_back(std::move(outcome));
      }
    for (std::size_t s = 0; s < point.outcomes.size(); ++s) point.rows.push_back(rows_of(as_recorded(point.outcomes[s], data_.settings[s]), data_.summaries));
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
  const auto axes = static_cast<Index>(model.candidate.parameters.size());
  const Predict predict = predictor(model, models_.front(), data_, scatter_.covariance);
  model.posterior = posterior_of(data_, predict, scatter_.covariance, axes, filling(look, axes));
  model.fitted_designs = model.design.size();
  model.error_at_fit.resize(0);
  const Index known = scene_axes(model.candidate);
  if (model.direct < 0 || known == axes || known == 0) return;
  // Along a valley the error of the recording goes with the coefficient: where that was simulated, and not where it is likeliest.
  VectorXd point = fitted_point(model);
  const Predict there = [&](const VectorXd& error) {
    point.tail(error.size()) = error;
    return predict(point);
  };
  model.error_at_fit = posterior_of(data_, there, scatter_.covariance, axes - known).best;
}

void BulkCampaign::simulate_fit(const std::string& stage, const std::vector<BulkModel*>& models, int seeds) {
  std::vector<Wanted> wanted;
  for (BulkModel* model : models) {
    if (model->direct >= 0) {
      const VectorXd& at = model->design[static_cast<std::size_t>(model->direct)].at;
      bool far = false;
      // Errors of the recording need no new simulation.
      for (Index k = 0; k < scene_axes(model->candidate); ++k) far = far || std::abs(at[k] - model->posterior.best[k]) > moved * model->posterior.sd(k);
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

/// More packings where the model was simulated directly.
void BulkCampaign::add_replicates(const std::string& stage, BulkModel& model, int seeds) {
  simulate(stage, {{&model, model.design[static_cast<std::size_t>(model.direct)].at, seeds}});
  const DesignPoint more = std::move(model.design.back());
  model.design.pop_back();
  DesignPoint& point = model.design[static_cast<std::size_t>(model.direct)];
  for (std::size_t s = 0; s < more.rows.size(); ++s) {
    point.outcomes[s].insert(point.outcomes[s].end(), more.outcomes[s].begin(), more.outcomes[s].end());
    MatrixXd rows(point.rows[s].rows() + more.rows[s].rows(), more.rows[s].cols());
    rows << point.rows[s], more.rows[s];
    point.rows[s] = std::move(rows);
  }
}

void BulkCampaign::more_of_nominal() {
  add_replicates("more of the nominal scene", models_.front(), options_.doubtful_seeds);
  find_scatter();
  fit(models_.front());
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

double BulkCampaign::worth(const BulkModel& model) {
  return model.posterior.best_log_likelihood - cost_of_parameter * static_cast<double>(model.candidate.parameters.size());
}

std::vector<BulkModel*> BulkCampaign::best_few() {
  std::vector<BulkModel*> list;
  for (BulkModel& model : models_)
    if (&model != &models_.front() && model.candidate.kind == BulkCandidate::Kind::simulated) list.push_back(&model);
  std::stable_sort(list.begin(), list.end(), [](const BulkModel* a, const BulkModel* b) { return worth(*a) > worth(*b); });
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

BulkModel* BulkCampaign::find(const std::vector<std::string>& effects) {
  const auto found = std::find_if(models_.begin(), models_.end(), [&](const BulkModel& m) { return m.candidate.hypothesis.names() == effects; });
  return found == models_.end() ? nullptr : &*found;
}

void BulkCampaign::numerics() {
  if (options_.numerics_seeds < 1) return;
  fit_numerics("time_step", "");
  fit_numerics("solver_tolerance", "");
  for (const std::string& backend : options_.other_backends) fit_numerics("engine_law", backend);
}

void BulkCampaign::fit_numerics(const char* effect, const std::string& backend) {
  BulkModel* const other = find({effect});
  models_.emplace_back();
  BulkModel& model = models_.back();
  model.candidate.kind = BulkCandidate::Kind::numerics;
  model.candidate.hypothesis.terms = {{find_effect(effect), ""}};
  model.candidate.backend = backend;
  const BulkModel& nominal = models_.front();
  model.candidate.calibrated = values_at(nominal.candidate, nominal.design[static_cast<std::size_t>(nominal.direct)].at);
  const std::size_t failed = failures_;
  const std::string stage = !backend.empty() ? "the nominal scene by " + backend : std::string(effect) == "time_step" ? "a finer step" : "a tighter tolerance";
  double best = worth(nominal);
  for (const BulkModel& m : models_)
    if (m.posterior.weight.size() > 0) best = std::max(best, worth(m));
  try {
    simulate(stage, {{&model, VectorXd(0), options_.numerics_seeds}});
    model.direct = 0;
    fit(model);
    if (model.posterior.best_log_likelihood > best - near_the_best && options_.direct_seeds > options_.numerics_seeds) {
      add_replicates(stage, model, options_.direct_seeds - options_.numerics_seeds);
      fit(model);
    }
  } catch (const BulkInterrupted&) {
    models_.pop_back();
    throw;
  }
  // An engine that lacks something of the scene says nothing, and did not fail; of several the best stands for all.
  if (!std::isfinite(model.posterior.best_log_likelihood)) {
    if (!backend.empty()) failures_ = failed;
    models_.pop_back();
  } else if (other != nullptr) {
    if (worth(model) > worth(*other)) *other = std::move(model);
    models_.pop_back();
  }
}

/// The two together as their sum; its posterior is foreseen.
BulkModel BulkCampaign::foreseen(const Predicted& a, const Predicted& b, const Predicted& nominal, int points) const {
  BulkModel pair;
  pair.candidate = together(a.model->candidate, b.model->candidate);
  pair.parts = {a.model, b.model};
  const auto axes = static_cast<Index>(pair.candidate.parameters.size());
  pair.posterior = posterior_of(data_, superposed(pair.candidate, a, b, nominal), scatter_.covariance, axes, filling(points, axes));
  return pair;
}

/// Pairs that are foreseen to be worth more than `least`, the best first.
std::vector<BulkModel> BulkCampaign::foresee_pairs(double least) const {
  const auto predicted = [&](const BulkModel& m) { return Predicted{&m, predictor(m, models_.front(), data_, scatter_.covariance)}; };
  const Predicted nominal = predicted(models_.front());
  std::vector<Predicted> singles;
  for (const BulkModel& m : models_)
    if (&m != &models_.front() && m.candidate.kind != BulkCandidate::Kind::numerics) singles.push_back(predicted(m));
  struct Two {
    std::size_t first, second;
    BulkModel model;
  };
  std::vector<Two> pairs;
  const auto best_first = [&] { std::stable_sort(pairs.begin(), pairs.end(), [](const Two& a, const Two& b) { return worth(a.model) > worth(b.model); }); };
  for (std::size_t i = 0; i < singles.size(); ++i)
    for (std::size_t j = i + 1; j < singles.size(); ++j) {
      pairs.push_back({i, j, foreseen(singles[i], singles[j], nominal, glance)});
      best_first();
      if (pairs.size() > looked_at) pairs.pop_back();
    }
  for (Two& pair : pairs) pair.model = foreseen(singles[pair.first], singles[pair.second], nominal, look);
  best_first();
  std::vector<BulkModel> promising;
  for (Two& pair : pairs)
    if (worth(pair.model) > least && promising.size() < static_cast<std::size_t>(options_.pairs)) promising.push_back(std::move(pair.model));
  return promising;
}

void BulkCampaign::pairs() {
  if (options_.pairs < 1) return;
  const BulkModel* best = nullptr;  // of those that can be tested
  for (const BulkModel& m : models_)
    if (&m != &models_.front() && (m.direct >= 0 || !is_simulated(m)) && (best == nullptr || worth(m) > worth(*best))) best = &m;
  if (best == nullptr || lack_of_fit(*best).p > level) return;
  std::vector<BulkModel*> added, to_simulate;
  std::vector<Wanted> wanted;
  for (BulkModel& pair : foresee_pairs(worth(*best) + least_gain_of_pair)) {
    models_.push_back(std::move(pair));
    added.push_back(&models_.back());
    if (!is_simulated(*added.back())) continue;
    to_simulate.push_back(added.back());
    const MatrixXd points = added.back()->posterior.representatives(options_.pair_points);
    for (Index i = 0; i < points.rows(); ++i) wanted.push_back({added.back(), points.row(i).transpose(), options_.refined_seeds});
  }
  try {
    if (!wanted.empty()) simulate("two effects at once", wanted);
    for (BulkModel* model : added) fit(*model);
    for (int round = 0; round < 2; ++round) simulate_fit("simulating the best pairs directly", to_simulate, options_.direct_seeds);
  } catch (const BulkInterrupted&) {
    // What was only foreseen is no result.
    for (std::size_t i = 0; i < added.size(); ++i) models_.pop_back();
    throw;
  }
  // Two that can each be built need not be able to be built together: what no simulation bears out is no result either.
  for (BulkModel* model : added)
    if (lack_of_fit(*model).dimensions == 0) model->posterior = {};
}

BulkCampaign::LackOfFit BulkCampaign::lack_of_fit(const BulkModel& model) const {
  return model.candidate.hypothesis.terms.size() > 1 ? lack_in_all(model) : lack_in_tested(model);
}

BulkCampaign::LackOfFit BulkCampaign::lack_in_tested(const BulkModel& model) const {
  LackOfFit result;
  std::vector<double> p;
  int spent = static_cast<int>(model.candidate.parameters.size());
  for (std::size_t s = 0; s < data_.settings.size(); ++s) {
    const MatrixXd simulated = columns(rows_at_fit(model, models_.front(), data_, s), data_.tested), recorded = columns(data_.settings[s].train, data_.tested);
    if (recorded.rows() == 0) continue;
    VectorXd extra(static_cast<Index>(data_.tested.size()));  // rounding is the same in every run
    for (Index k = 0; k < extra.size(); ++k)
      extra[k] = data_.extra[data_.tested[static_cast<std::size_t>(k)]] + static_cast<double>(recorded.rows()) * std::pow(resolution * recorded.col(k).cwiseAbs().maxCoeff(), 2);
    const int here = std::min(spent, static_cast<int>(data_.tested.size()));
    spent -= here;
    const MeanTest test = same_mean(recorded, simulated, extra, here);
    if (test.dimensions == 0) continue;
    p.push_back(test.p);
    result.dimensions += test.dimensions;
    const double rows = test.dof + test.dimensions - 1;
    result.ratio = std::max(result.ratio, test.statistic * test.dof / (rows * test.dimensions));
  }
  result.p = combined_p(p);
  return result;
}

/// T^2 of all summaries with the shrunken scatter, whose degrees of freedom are those of all seeds:
///   F = T^2 (nu - d + 1) / (nu d) ~ F(d, nu - d + 1),   d = summaries less what was fitted; settings by Fisher
BulkCampaign::LackOfFit BulkCampaign::lack_in_all(const BulkModel& model) const {
  LackOfFit result;
  std::vector<double> p;
  int spent = static_cast<int>(model.candidate.parameters.size());
  for (std::size_t s = 0; s < data_.settings.size(); ++s) {
    const MatrixXd simulated = complete_rows(rows_at_fit(model, models_.front(), data_, s)), recorded = complete_rows(data_.settings[s].train);
    if (simulated.rows() == 0 || recorded.rows() == 0) continue;
    const double na = static_cast<double>(recorded.rows()), nb = static_cast<double>(simulated.rows());
    MatrixXd c = scatter_.covariance * (1 / na + 1 / nb);
    c.diagonal() += data_.extra / na;
    const double statistic = squared_distance((recorded.colwise().mean() - simulated.colwise().mean()).transpose(), c);
    const int numbers = static_cast<int>(c.rows()), here = std::min(spent, numbers), d = numbers - here;
    spent -= here;
    const double left = scatter_.dof - d + 1;
    if (d < 1 || left <= 0 || !std::isfinite(statistic)) continue;
    const double ratio = statistic * left / (scatter_.dof * d);
    p.push_back(boost::math::cdf(boost::math::complement(boost::math::fisher_f(d, left), ratio)));
    result.dimensions += d;
    result.ratio = std::max(result.ratio, ratio);
  }
  result.p = combined_p(p);
  return result;
}

}  // namespace repose::diagnosis
