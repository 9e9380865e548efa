#pragma once
/// How far a run is, told on stderr: a bar with the time left on a terminal, a plain line every few seconds elsewhere.
#include <string>

#include "core/run.hpp"

namespace repose {

class ProgressDisplay {
 public:
  /// With `quiet` only messages are shown.
  explicit ProgressDisplay(bool quiet);
  ~ProgressDisplay();
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  /// For RunHooks::progress.
  void show(const Progress& progress);
  /// For anything counted (jobs of a study): `done` of `total` and a text behind the bar.
  void show(double done, double total, double remaining_s, const std::string& text);
  /// A line of its own that the bar does not run over.
  void message(const std::string& text);

 private:
  bool quiet_, terminal_;
  bool bar_shown_ = false;
  double last_line_s_ = -1e300;
};

/// "42 s", "3 min 12 s", "2 h 5 min".
std::string duration_text(double seconds);

}  // namespace repose
