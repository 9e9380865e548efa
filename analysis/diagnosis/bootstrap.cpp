#include "analysis/diagnosis/bootstrap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/bundle/sensor.hpp"
#include "analysis/diagnosis/horizon.hpp"
#include "analysis/diagnosis/recorded_noise.hpp"
#include "core/random.hpp"

namespace repose::diagnosis {
namespace {

constexpr std::uint64_t first_stream = 1000;
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// The observation with nothing in it that a channel will not fill.
Observation emptied(Observation o) {
  for (Vec3& p : o.position) p.setConstant(missing);
  for (double& v : o.value) v = missing;
  return o;
}

}  // namespace

Bundle replica_of(const Problem& problem, const Fit& nominal, std::uint64_t seed, std::uint64_t number) {
  Bundle replica = problem.bundle();
  replica.runs.clear();
  replica.split_given = true;
  std::vector<std::size_t> all(problem.bundle().runs.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const std::map<std::string, NoiseModel> noise = recorded_noise(problem.bundle(), all);
  Random random(seed, first_stream + number);
  for (const std::size_t run : nominal.runs) {
    const RunData& data = problem.runs()[run];
    BundleRun made = *data.run;
    made.held_out = false;
    for (Observation& o : made.observations) o = emptied(o);
    const Eigen::VectorXd d = problem.plain_residual(nominal.layout, run, nominal.shared, nominal.own[run]);
    std::map<std::size_t, std::map<std::size_t, Vec3>> turns;  // by observation and sample
    for (const Channel& c : data.channels) {
      const NoiseModel sensor = noise.at(c.observable);
      const Observation& recorded = data.run->observations[c.observation];
      Observation& o = made.observations[c.observation];
      const std::vector<double> phi = correlations(sensor.phi, c.time);
      double e = 0;
      for (std::size_t k = 0; k < c.time.size(); ++k) {
        e = phi[k] * e + std::sqrt(1 - phi[k] * phi[k]) * normal(random);
        const double moved = c.noise * d[c.first + static_cast<Eigen::Index>(k)] + sensor.sd * e;
        const std::size_t i = c.at[k];
        if (c.observable == "position")
          o.position[i][c.axis] = recorded.position[i][c.axis] + moved;
        else if (c.observable == "orientation")
          turns[c.observation].try_emplace(i, Vec3::Zero()).first->second[c.axis] = moved;
        else
          o.value[i] = recorded.value[i] + moved;
      }
    }
    for (const auto& [n, samples] : turns) {
      std::vector<Quat>& orientation = made.observations[n].orientation;
      for (std::size_t i = 0; i < orientation.size(); ++i) {
        const auto turn = samples.find(i);
        orientation[i] = turn == samples.end() ? Quat(missing, missing, missing, missing) : (rotation_of(turn->second) * orientation[i]).normalized();
      }
    }
    replica.runs.push_back(std::move(made));
  }
  return replica;
}

NullDistribution bootstrap(const Problem& problem, const Fit& nominal, const Simulate& simulate, int replicas, const SearchOptions& options,
                           bool coarser_step) {
  NullDistribution null;
  SearchOptions quiet = options;
  quiet.progress = nullptr;
  for (int b = 0; b < replicas; ++b) {
    if (options.progress) options.progress("bootstrap of the lack of fit", b, replicas);
    if (options.interrupted && options.interrupted()) break;
    const Bundle bundle = replica_of(problem, nominal, options.seed, static_cast<std::uint64_t>(b));
    std::vector<std::size_t> runs(bundle.runs.size());
    std::iota(runs.begin(), runs.end(), std::size_t{0});
    Problem again(bundle, runs, simulate, nullptr, coarser_step);
    FitOptions fit;
    fit.threads = options.threads;
    fit.interrupted = options.interrupted;
    follow_further(again, fit);
    Search search(again, runs, quiet);
    search.run_nominal();
    null.largest.push_back(search.lack_of_fit().deviate);
  }
  std::sort(null.largest.begin(), null.largest.end());
  return null;
}

}  // namespace repose::diagnosis
