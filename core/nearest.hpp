#pragma once
/// "Did you mean ...?": the entry of a list that is closest to a misspelt word.
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace repose {

/// Smallest number of insertions, deletions, replacements and swaps of neighbours that turns `a` into `b`
/// (Damerau-Levenshtein, optimal string alignment). Bytes, not characters.
int edit_distance(std::string_view a, std::string_view b);

/// The candidate closest to `word` (the first of equals), or "" if none is closer than half the longer length. A
/// candidate that begins with the word, or holds it whole, counts as close.
std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// "a, b, c", for messages; at most `limit` entries, then "... (n in all)".
std::string listing(std::span<const std::string> entries, std::size_t limit = 40);

}  // namespace repose
