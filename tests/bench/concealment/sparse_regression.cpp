#include "tests/bench/concealment/sparse_regression.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/bench/concealment/true_world.hpp"

namespace repose::concealment {
namespace {

constexpr int half_window = 4;
constexpr double significant = 5;  // standard errors

struct Smoothed {
  bool good = false;
  Vec3 velocity = Vec3::Zero(), acceleration = Vec3::Zero();
};

/// Cubics through the samples around `i`, without those that are missing.
Smoothed smoothed(const std::vector<double>& time, const std::vector<Vec3>& x, std::size_t i) {
  std::vector<std::size_t> used;
  for (std::size_t k = i - half_window; k <= i + half_window; ++k)
    if (x[k].allFinite()) used.push_back(k);
  if (used.size() < 6) return {};
  Eigen::MatrixXd powers(static_cast<Eigen::Index>(used.size()), 4), values(powers.rows(), 3);
  for (Eigen::Index row = 0; row < powers.rows(); ++row) {
    const std::size_t k = used[static_cast<std::size_t>(row)];
    const double t = time[k] - time[i];
    powers.row(row) << 1, t, t * t, t * t * t;
    values.row(row) = x[k].transpose();
  }
  const Eigen::MatrixXd c = powers.colPivHouseholderQr().solve(values);
  return {true, c.row(1).transpose(), 2 * c.row(2).transpose()};
}

Vec3 spin_at(const Observation& o, std::size_t i) {
  if (o.orientation.empty()) return Vec3::Zero();
  Quat turn = o.orientation[i + 1] * o.orientation[i - 1].conjugate();
  if (turn.w() < 0) turn.coeffs() *= -1;
  const Eigen::AngleAxisd angle(turn);
  const Vec3 spin = angle.angle() * angle.axis() / (o.time[i + 1] - o.time[i - 1]);
  return spin.allFinite() ? spin : Vec3(Vec3::Zero());
}

constexpr std::size_t functions = 7;
const std::array<const char*, functions> effect_of{"uniform_force", "uniform_force", "uniform_force", "linear_drag", "quadratic_drag", "magnus", "rolling_friction"};

using Rows = std::vector<std::pair<Vec3, std::array<Vec3, functions>>>;

void add_rows(const Bundle& bundle, const BundleRun& run, const Observation& o, Rows& rows) {
  Experiment plan;
  plan.observables = {Observation{}};
  plan.observables[0].name = "position";
  plan.observables[0].body = o.body;
  std::vector<Override> set = run.set;
  const History nominal = live(bundle.scene.text, set, o.body, {"dvi", 1, 1, {}});
  const BodyTrack& track = nominal.bodies.at(o.body);
  std::vector<Vec3> plain;
  for (const double t : o.time) plain.push_back(sample(nominal, track, t).position);
  for (std::size_t i = half_window; i + half_window < o.time.size(); ++i) {
    const Smoothed seen = smoothed(o.time, o.position, i), expected = smoothed(o.time, plain, i);
    if (!seen.good || !expected.good || seen.velocity.norm() == 0) continue;
    const bool supported = std::abs(expected.acceleration.z()) < 0.2 * nominal.gravity.norm();
    const Vec3 along = supported ? Vec3(seen.velocity.normalized()) : Vec3(Vec3::Zero());
    rows.push_back({seen.acceleration - expected.acceleration,
                    {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(), seen.velocity, seen.velocity.norm() * seen.velocity,
                     spin_at(o, i).cross(seen.velocity), along}});
  }
}

}  // namespace

std::string sparse_regression(const Bundle& bundle) {
  Rows rows;
  for (const BundleRun& run : bundle.runs)
    for (const Observation& o : run.observations)
      if (!run.held_out && o.kind == ObservableKind::trajectory) add_rows(bundle, run, o, rows);
  if (rows.size() < 20) return "";
  const auto n = static_cast<Eigen::Index>(3 * rows.size());
  Eigen::MatrixXd all(n, static_cast<Eigen::Index>(functions));
  Eigen::VectorXd left(n);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto row = static_cast<Eigen::Index>(3 * r);
    left.segment<3>(row) = rows[r].first;
    for (std::size_t f = 0; f < functions; ++f) all.block<3, 1>(row, static_cast<Eigen::Index>(f)) = rows[r].second[f];
  }
  std::vector<std::size_t> kept;
  for (std::size_t f = 0; f < functions; ++f)
    if (all.col(static_cast<Eigen::Index>(f)).norm() > 1e-9) kept.push_back(f);
  while (!kept.empty()) {
    Eigen::MatrixXd columns(n, static_cast<Eigen::Index>(kept.size()));
    for (std::size_t k = 0; k < kept.size(); ++k) columns.col(static_cast<Eigen::Index>(k)) = all.col(static_cast<Eigen::Index>(kept[k]));
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
    const Eigen::VectorXd c = qr.solve(left);
    const double variance = (left - columns * c).squaredNorm() / static_cast<double>(n - columns.cols());
    const Eigen::MatrixXd inverse = (columns.transpose() * columns).completeOrthogonalDecomposition().pseudoInverse();
    // Windows overlap: one in nine residuals is new.
    const Eigen::VectorXd t = c.array().abs() / (inverse.diagonal().array() * variance * (2 * half_window + 1)).max(1e-300).sqrt();
    Eigen::Index weakest = 0, strongest = 0;
    if (t.minCoeff(&weakest) < significant) {
      kept.erase(kept.begin() + weakest);
      continue;
    }
    (c.array().abs() * columns.colwise().norm().transpose().array()).maxCoeff(&strongest);
    return effect_of[kept[static_cast<std::size_t>(strongest)]];
  }
  return "";
}

}  // namespace repose::concealment
