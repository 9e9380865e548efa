#pragma once
/// Figures from publications, with source and uncertainty: the files of analysis/reference/<set>/.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/statistics.hpp"

namespace repose {

struct ReferenceValue {
  std::string observable;             ///< "angle_of_repose"
  std::optional<double> x;            ///< the parameter it belongs to, in the set's `x`
  double value = 0;                   ///< in `unit`
  std::optional<double> uncertainty;  ///< in `unit`, > 0; what it means is said in the file
  std::string unit;
};

struct ReferenceSet {
  std::string title, source, method;
  std::string x;  ///< name of the parameter; may be empty
  std::vector<ReferenceValue> values;

  /// The values of one observable that have an x, in ascending order of it.
  std::vector<ReferenceValue> curve(const std::string& observable) const;
  /// The only value of an observable; nullopt if there is none or several.
  std::optional<ReferenceValue> single(const std::string& observable) const;
};

/// Throws Error naming file, line and key.
ReferenceSet load_reference(const std::filesystem::path& file);

/// A straight line through such a curve: errors from the scatter about the line; nullopt with fewer than three values.
std::optional<Line> reference_line(const std::vector<ReferenceValue>& curve);

}  // namespace repose
