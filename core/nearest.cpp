#include "core/nearest.hpp"

#include <algorithm>

namespace repose {

int edit_distance(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<int> before_last(width), last(width), row(width);
  for (std::size_t j = 0; j < width; ++j) last[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j < width; ++j) {
      const int replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

std::string nearest(std::string_view word, std::span<const std::string> candidates) {
  // Distances are quadratic in the length; no key is this long.
  if (word.empty() || word.size() > 200) return "";
  std::string best;
  double best_score = 0.5;
  for (const std::string& candidate : candidates) {
    const double longer = static_cast<double>(std::max(word.size(), candidate.size()));
    double score = edit_distance(word, candidate) / longer;
    const bool holds = word.size() >= 3 && candidate.find(word) != std::string::npos;
    const bool held = candidate.size() >= 3 && word.find(candidate) != std::string_view::npos;
    if (holds || held) score = std::min(score, 0.4);
    if (score < best_score) {
      best_score = score;
      best = candidate;
    }
  }
  return best;
}

std::string listing(std::span<const std::string> entries, std::size_t limit) {
  std::string text;
  for (std::size_t i = 0; i < std::min(entries.size(), limit); ++i) text += (i == 0 ? "" : ", ") + entries[i];
  if (entries.size() > limit) text += ", ... (" + std::to_string(entries.size()) + " in all)";
  return text;
}

}  // namespace repose
