#include "analysis/statistics.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <vector>

#include "core/error.hpp"

namespace repose {
namespace {

void require_finite(std::span<const double> values) {
  for (double v : values)
    if (!std::isfinite(v)) throw Error("statistics", "a value is not finite", "leave missing values out");
}

struct Moments {
  double weight = 0, x = 0, y = 0, xx = 0, xy = 0;  // xx and xy about the weighted means
};

template <class Weight>
Moments moments(std::span<const double> x, std::span<const double> y, Weight weight) {
  Moments m;
  for (std::size_t i = 0; i < x.size(); ++i) {
    m.weight += weight(i);
    m.x += weight(i) * x[i];
    m.y += weight(i) * y[i];
  }
  m.x /= m.weight;
  m.y /= m.weight;
  for (std::size_t i = 0; i < x.size(); ++i) {
    m.xx += weight(i) * (x[i] - m.x) * (x[i] - m.x);
    m.xy += weight(i) * (x[i] - m.x) * (y[i] - m.y);
  }
  return m;
}

Line line_through(const Moments& m, std::span<const double> x, std::span<const double> y) {
  if (!(m.xx > 0)) throw Error("statistics", "a line needs at least two different x", "give more points");
  Line line;
  line.n = x.size();
  line.slope = m.xy / m.xx;
  line.intercept = m.y - line.slope * m.x;
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += std::pow(y[i] - line.at(x[i]), 2);
  line.rms = std::sqrt(sum / static_cast<double>(x.size()));
  return line;
}

void require_pairs(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size() || x.size() < 2)
    throw Error("statistics", "a line needs as many y as x, and at least two", "give more points");
  require_finite(x);
  require_finite(y);
}

}  // namespace

Summary summarise(std::span<const double> values) {
  require_finite(values);
  Summary r;
  r.n = values.size();
  if (r.n == 0) return r;
  for (double v : values) r.mean += v;
  r.mean /= static_cast<double>(r.n);
  if (r.n < 2) return r;
  double sum = 0;
  for (double v : values) sum += (v - r.mean) * (v - r.mean);
  r.sd = std::sqrt(sum / static_cast<double>(r.n - 1));
  r.se = r.sd / std::sqrt(static_cast<double>(r.n));
  return r;
}

Line fit_line(std::span<const double> x, std::span<const double> y) {
  require_pairs(x, y);
  const Moments m = moments(x, y, [](std::size_t) { return 1.0; });
  Line line = line_through(m, x, y);
  if (line.n > 2) {
    const double variance = line.rms * line.rms * static_cast<double>(line.n) / static_cast<double>(line.n - 2);
    line.slope_se = std::sqrt(variance / m.xx);
    line.intercept_se = std::sqrt(variance * (1 / m.weight + m.x * m.x / m.xx));
  }
  return line;
}

Line fit_line(std::span<const double> x, std::span<const double> y, std::span<const double> sigma) {
  require_pairs(x, y);
  if (sigma.size() != x.size()) throw Error("statistics", "one sigma per point is needed", "give as many sigmas as points");
  for (double s : sigma)
    if (!(s > 0) || !std::isfinite(s)) throw Error("statistics", "a sigma is not positive", "use the unweighted fit");
  const Moments m = moments(x, y, [&](std::size_t i) { return 1 / (sigma[i] * sigma[i]); });
  Line line = line_through(m, x, y);
  line.slope_se = std::sqrt(1 / m.xx);
  line.intercept_se = std::sqrt(1 / m.weight + m.x * m.x / m.xx);
  return line;
}

double student_t_quantile(double probability, int dof) {
  if (!(probability > 0 && probability < 1) || dof < 1)
    throw Error("statistics", "Student's quantile needs a probability in (0, 1) and dof >= 1", "");
  return boost::math::quantile(boost::math::students_t(dof), probability);
}

}  // namespace repose
