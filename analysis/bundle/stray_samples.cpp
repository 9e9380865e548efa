#include "analysis/bundle/stray_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace repose {
namespace {

constexpr double far = 100;       // times what second differences usually are: sensors with heavy tails err by 50
constexpr double far_here = 6;    // times those beside it: where a body is hit, samples bend as well
constexpr std::size_t beside = 4; // samples on either side
constexpr double far_away = 5;    // times the usual way from one sample to the next
constexpr double alike = 0.2;     // of a jump: both neighbours' second differences are half of it
constexpr std::size_t fewest = 8; // samples that tell what is usual
constexpr double rms_of_median = 0.6745;

/// Each sample less the middle of its neighbours [m]; NaN where one of the three is missing.
std::vector<double> bends(const Observation& o, int axis) {
  std::vector<double> bend(o.position.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 1; i + 1 < bend.size(); ++i) bend[i] = o.position[i][axis] - 0.5 * (o.position[i - 1][axis] + o.position[i + 1][axis]);
  return bend;
}

double usual(const std::vector<double>& bend) {
  std::vector<double> sizes;
  for (const double b : bend)
    if (std::isfinite(b)) sizes.push_back(std::abs(b));
  if (sizes.size() < fewest) return std::numeric_limits<double>::infinity();
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle / rms_of_median;
}

bool jumps_and_returns(const std::vector<double>& bend, std::size_t i, double usually) {
  if (!(std::abs(bend[i]) > far * usually)) return false;
  for (std::size_t j = i > beside ? i - beside : 0; j < std::min(bend.size(), i + beside + 1); ++j)
    if ((j + 1 < i || j > i + 1) && std::abs(bend[i]) < far_here * std::abs(bend[j])) return false;
  const auto half = [&](double neighbour) { return std::abs(neighbour + 0.5 * bend[i]) < alike * std::abs(bend[i]); };
  return half(bend[i - 1]) && half(bend[i + 1]);
}

/// Axes that are not observed count as zero.
Vec3 observed(Vec3 p) {
  for (double& x : p)
    if (!std::isfinite(x)) x = 0;
  return p;
}

double usual_way(const Observation& o) {
  std::vector<double> ways;
  for (std::size_t i = 1; i < o.position.size(); ++i)
    ways.push_back((observed(o.position[i]) - observed(o.position[i - 1])).norm());
  const auto middle = ways.begin() + static_cast<std::ptrdiff_t>(ways.size() / 2);
  std::nth_element(ways.begin(), middle, ways.end());
  return *middle;
}

bool zero(const Vec3& p) {
  bool any = false;
  for (int k = 0; k < 3; ++k) {
    if (!std::isfinite(p[k])) continue;
    if (p[k] != 0) return false;
    any = true;
  }
  return any;
}

}  // namespace

std::vector<std::string> stray_samples(const Observation& o) {
  std::vector<std::string> found;
  if (o.position.size() < fewest) return found;
  std::size_t strays = 0, zeros = 0, first_stray = 0, first_zero = 0;
  for (int k = 0; k < 3; ++k) {
    const std::vector<double> bend = bends(o, k);
    const double usually = usual(bend);
    if (!std::isfinite(usually) || usually == 0) continue;
    for (std::size_t i = 2; i + 2 < bend.size(); ++i)
      if (jumps_and_returns(bend, i, usually) && strays++ == 0) first_stray = i;
  }
  const double way = usual_way(o);
  for (std::size_t i = 1; i < o.position.size() && way > 0; ++i)  // a body that mostly rests may do so at zero
    if (zero(o.position[i]) && (zero(o.position[i - 1]) ? zeros > 0 : observed(o.position[i - 1]).norm() > far_away * way))
      if (zeros++ == 0) first_zero = i;
  if (zeros > 0)
    found.push_back(fmt::format("`{}` is exactly zero in all axes in {} sample{}, first at {:.6g} s, amid others that are far away; a gap is an empty cell, not a zero", o.name, zeros,
                                zeros == 1 ? "" : "s", o.time[first_zero]));
  else if (strays > 0)
    found.push_back(fmt::format("`{}` jumps away and back within one sample, first at {:.6g} s; was it misread? Leave such a cell empty", o.name, o.time[first_stray]));
  return found;
}

}  // namespace repose
