#include "scenarios/diagnosis_progress.hpp"

#include <algorithm>
#include <array>

namespace repose {
namespace {

struct Stage {
  const char* begins;  ///< of its name
  double weight;       ///< typical time, of recordings of a few bodies
};

/// In their order.
constexpr std::array<Stage, 10> stages = {{{"calibrating", 4},
                                           {"screening candidates", 20},
                                           {"locating", 6},
                                           {"fitting candidates", 20},
                                           {"screening a second", 20},
                                           {"fitting pairs", 12},
                                           {"a finer", 2},
                                           {"runs that were held out", 8},
                                           {"intervals", 4},
                                           {"a recording", 4}}};

constexpr double first_estimate = 0.02;

}  // namespace

double DiagnosisProgress::share(const std::string& stage, double done, double total) {
  double before = 0, all = 0, inside = -1;
  for (const Stage& s : stages) {
    if (stage.starts_with(s.begins)) {
      before = all;
      inside = s.weight * (total > 0 ? std::clamp(done / total, 0.0, 1.0) : 0);
    }
    all += s.weight;
  }
  if (inside >= 0) share_ = std::clamp((before + inside) / all, share_, 0.99);
  return share_;
}

double DiagnosisProgress::left(double spent) const { return share_ < first_estimate ? 0 : spent * (1 - share_) / share_; }

}  // namespace repose
