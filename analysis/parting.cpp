#include "analysis/parting.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include "core/error.hpp"

namespace repose {
namespace {

constexpr std::size_t most_ways = 2000;
constexpr double rounding = 1e-9;  // relative: mirrored ways give the same T up to this

/// Runs of both ensembles in one list, the first `count` of them a's, and which of them a way puts into a.
class Deals {
 public:
  Deals(std::size_t total, std::size_t count) : in_a_(total, false) {
    std::fill_n(in_a_.begin(), count, true);
    double all = 1;
    for (std::size_t k = 1; k <= count; ++k) all *= static_cast<double>(total - count + k) / static_cast<double>(k);
    exhaustive_ = all < static_cast<double>(most_ways) + 0.5;
    size_ = exhaustive_ ? static_cast<std::size_t>(std::llround(all)) : most_ways;
  }
  std::size_t size() const { return size_; }
  const std::vector<bool>& current() const { return in_a_; }
  void next() {
    if (exhaustive_)
      std::prev_permutation(in_a_.begin(), in_a_.end());
    else
      // Not std::shuffle: its result depends on the library.
      for (std::size_t i = in_a_.size() - 1; i > 0; --i) {
        const std::size_t j = random_() % (i + 1);
        const bool kept = in_a_[i];
        in_a_[i] = in_a_[j];
        in_a_[j] = kept;
      }
  }

 private:
  std::vector<bool> in_a_;
  bool exhaustive_ = true;
  std::size_t size_ = 0;
  std::mt19937_64 random_{1};
};

struct Sums {
  double n = 0, sum = 0, squares = 0;
  void add(double x) {
    ++n;
    sum += x;
    squares += x * x;
  }
  double mean() const { return sum / n; }
  double error_squared() const { return std::max(0.0, (squares - sum * sum / n) / (n - 1)) / n; }
};

/// Values about the mean of both ensembles, so that sums of squares keep their digits: run by run.
std::vector<Film> centred(std::span<const Film> a, std::span<const Film> b) {
  std::vector<Film> all(a.begin(), a.end());
  all.insert(all.end(), b.begin(), b.end());
  for (std::size_t i = 0; i < all.front().size(); ++i) {
    double mean = 0;
    for (const Film& film : all) mean += film[i] / static_cast<double>(all.size());
    for (Film& film : all) film[i] -= mean;
  }
  return all;
}

/// s0 of each kind of cell.
std::map<int, double> floors(const std::vector<Film>& all, std::span<const int> kind, double na, double nb) {
  std::map<int, std::vector<double>> errors;
  const double n = static_cast<double>(all.size());
  for (std::size_t i = 0; i < all.front().size(); ++i) {
    double squares = 0;
    for (const Film& film : all) squares += film[i] * film[i];
    if (squares > 0) errors[kind[i % kind.size()]].push_back(std::sqrt(squares / (n - 1) * (1 / na + 1 / nb)));
  }
  std::map<int, double> result;
  for (auto& [k, list] : errors) {
    std::nth_element(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2), list.end());
    result[k] = list[list.size() / 2];
  }
  return result;
}

void demand(std::span<const Film> a, std::span<const Film> b, std::span<const int> kind, double alpha) {
  if (a.size() < 2 || b.size() < 2) throw Error("parting", "each ensemble needs at least two runs", "add seeds");
  if (!(alpha > 0 && alpha < 1)) throw Error("parting", "alpha must be in (0, 1)", "");
  const std::size_t length = a.front().size();
  for (const std::span<const Film>& films : {a, b})
    for (const Film& film : films)
      if (film.size() != length || kind.empty() || length % kind.size() != 0)
        throw Error("parting", "films differ in length, or do not fit the cells", "compare runs of one schedule");
}

}  // namespace

Parting first_parting(std::span<const Film> a, std::span<const Film> b, std::span<const int> kind, double alpha) {
  demand(a, b, kind, alpha);
  const std::vector<Film> all = centred(a, b);
  const std::map<int, double> floor = floors(all, kind, static_cast<double>(a.size()), static_cast<double>(b.size()));
  const std::size_t length = all.front().size();
  std::vector<double> s0(kind.size(), 0);
  for (std::size_t c = 0; c < kind.size(); ++c)
    if (const auto found = floor.find(kind[c]); found != floor.end()) s0[c] = found->second;

  const auto statistic = [&](std::size_t i, const std::vector<bool>& in_a) {
    Sums x, y;
    for (std::size_t r = 0; r < all.size(); ++r) (in_a[r] ? x : y).add(all[r][i]);
    const double below = std::sqrt(x.error_squared() + y.error_squared()) + s0[i % kind.size()];
    return below > 0 ? std::abs(x.mean() - y.mean()) / below : 0.0;
  };

  Deals deals(all.size(), a.size());
  std::vector<double> observed(length);
  for (std::size_t i = 0; i < length; ++i) observed[i] = statistic(i, deals.current());
  std::vector<double> maxima;
  for (std::size_t way = 0; way < deals.size(); ++way, deals.next()) {
    double most = 0;
    for (std::size_t i = 0; i < length; ++i) most = std::max(most, statistic(i, deals.current()));
    maxima.push_back(most);
  }
  std::sort(maxima.begin(), maxima.end());
  const double ways = static_cast<double>(maxima.size());
  const auto p_of = [&](double t) {
    const auto from = std::lower_bound(maxima.begin(), maxima.end(), t * (1 - rounding));
    return std::max(1.0, static_cast<double>(maxima.end() - from)) / ways;
  };
  const auto place = [&](std::size_t i) {
    Sums x, y, about_x, about_y;
    for (std::size_t r = 0; r < a.size(); ++r) x.add(a[r][i]), about_x.add(all[r][i]);
    for (std::size_t r = 0; r < b.size(); ++r) y.add(b[r][i]), about_y.add(all[a.size() + r][i]);
    return PartingPlace{i / kind.size(), i % kind.size(), observed[i], p_of(observed[i]), x.mean(), y.mean(),
                        std::sqrt(about_x.error_squared() + about_y.error_squared())};
  };

  Parting result;
  result.ways = maxima.size();
  result.least_p = (a.size() == b.size() ? 2 : 1) / ways;
  const auto top = std::max_element(observed.begin(), observed.end());
  result.largest = place(static_cast<std::size_t>(top - observed.begin()));
  for (std::size_t from = 0; from < length && !result.first; from += kind.size()) {
    const auto best = std::max_element(observed.begin() + static_cast<std::ptrdiff_t>(from),
                                       observed.begin() + static_cast<std::ptrdiff_t>(from + kind.size()));
    if (*best > 0 && p_of(*best) <= alpha) result.first = place(static_cast<std::size_t>(best - observed.begin()));
  }
  return result;
}

}  // namespace repose
