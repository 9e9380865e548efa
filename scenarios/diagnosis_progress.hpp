#pragma once
/// How far a whole diagnosis is, from what its stages tell.
#include <string>

namespace repose {

/// Stages take typical shares of the time. A stage that comes again (everything is judged anew from a better nominal fit) holds the share
/// where it is, so that it never falls and the time left grows instead.
class DiagnosisProgress {
 public:
  /// `done` of `total` of a stage: the share of the whole job that is done, in [0, 1).
  double share(const std::string& stage, double done, double total);

  /// `spent` / share - `spent`: as long again as the rest is large [s]; 0 (not known yet) below 2 %.
  double left(double spent) const;

 private:
  double share_ = 0;
};

}  // namespace repose
