#include "analysis/diagnosis/split.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/error.hpp"
#include "core/random.hpp"

namespace repose::diagnosis {
namespace {

/// At most `limit` of the list, evenly spread.
std::vector<std::size_t> thinned(const std::vector<std::size_t>& list, int limit) {
  const auto n = static_cast<std::size_t>(limit);
  if (list.size() <= n) return list;
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < n; ++i) result.push_back(list[i * list.size() / n]);
  return result;
}

}  // namespace

Split split_runs(const Bundle& bundle, int max_train, int max_held, std::uint64_t seed, std::vector<std::string>& notes) {
  Split split;
  if (bundle.split_given) {
    for (std::size_t i = 0; i < bundle.runs.size(); ++i) (bundle.runs[i].held_out ? split.held : split.train).push_back(i);
    if (split.train.empty()) throw Error("runs", "all runs are held out: nothing is left to fit", "let some runs have `held_out: false`");
  } else {
    std::vector<std::size_t> order(bundle.runs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    Random random(seed, 5);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
    const std::size_t held = order.size() < 2 ? 0 : std::max<std::size_t>(1, order.size() / 3);
    split.held.assign(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(held));
    split.train.assign(order.begin() + static_cast<std::ptrdiff_t>(held), order.end());
    std::sort(split.held.begin(), split.held.end());
    std::sort(split.train.begin(), split.train.end());
    notes.push_back(fmt::format("No run says whether it is held out: {} of {} were, chosen by seed {}.", held, order.size(), seed));
  }
  const Split used{thinned(split.train, max_train), thinned(split.held, max_held)};
  if (used.train.size() < split.train.size() || used.held.size() < split.held.size())
    notes.push_back(fmt::format("Used {} of {} runs for fitting and {} of {} held-out ones, evenly spread over the list.", used.train.size(),
                                split.train.size(), used.held.size(), split.held.size()));
  if (used.held.empty()) notes.push_back("Nothing is held out: candidates are weighed on the data that they were fitted to, less what their parameters cost.");
  return used;
}

}  // namespace repose::diagnosis
