#include "analysis/two_samples.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/statistics.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

MeanDifference judged(double value, double se, double dof) {
  MeanDifference d{value, se, dof, 0, 1};
  if (se > 0) {
    d.t = value / se;
    d.p = student_two_sided(d.t, dof);
  } else if (value != 0) {
    d.t = std::copysign(std::numeric_limits<double>::infinity(), value);
    d.p = 0;
  }
  return d;
}

}  // namespace

double student_two_sided(double t, double dof) {
  if (!(dof > 0)) throw Error("statistics", "Student's distribution needs positive degrees of freedom", "");
  return std::min(1.0, 2 * boost::math::cdf(boost::math::complement(boost::math::students_t(dof), std::abs(t))));
}

MeanDifference paired_difference(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size() || a.size() < 2)
    throw Error("statistics", "a paired test needs two samples of the same length, at least two", "use Welch's test");
  std::vector<double> difference(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) difference[i] = a[i] - b[i];
  const Summary s = summarise(difference);
  return judged(s.mean, s.se, static_cast<double>(s.n - 1));
}

MeanDifference welch_difference(std::span<const double> a, std::span<const double> b) {
  const Summary x = summarise(a), y = summarise(b);
  if (x.n < 2 || y.n < 2) throw Error("statistics", "Welch's test needs at least two values in each sample", "add seeds");
  const double va = x.se * x.se, vb = y.se * y.se, sum = va + vb;
  const double spread = va * va / static_cast<double>(x.n - 1) + vb * vb / static_cast<double>(y.n - 1);
  return judged(x.mean - y.mean, std::sqrt(sum), spread > 0 ? sum * sum / spread : 0);
}

std::vector<double> holm(std::span<const double> p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return p[i] < p[j]; });
  std::vector<double> corrected(p.size());
  double running = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    running = std::max(running, std::min(1.0, static_cast<double>(p.size() - k) * p[order[k]]));
    corrected[order[k]] = running;
  }
  return corrected;
}

}  // namespace repose
