#include "scenarios/diagnosis_progress.hpp"

#include <algorithm>
#include <array>

namespace repose {
namespace {

struct Stage {
  const char* begins;    ///< of its name
  const char* contains;  ///< likewise, further on
  double weight;         ///< typical time, of recordings of a few bodies
};

/// In their order. A name counts for the last one that it suits.
constexpr std::array<Stage, 14> stages = {{{"calibrating", "", 4},
                                           {"screening candidates", "", 15},
                                           {"locating", "", 5},
                                           {"another way to solve it", "", 8},
                                           {"trying ", "", 10},
                                           {"fitting ", "", 10},
                                           {"", " as engines solve it", 10},
                                           {"screening a second", "", 15},
                                           {"trying ", " + ", 8},
                                           {"", " from where ", 6},
                                           {"bootstrap", "", 20},
                                           {"runs that were held out", "", 6},
                                           {"intervals", "", 4},
                                           {"a recording", "", 4}}};

constexpr double first_estimate = 0.02;

}  // namespace

double DiagnosisProgress::share(const std::string& stage, double done, double total) {
  double before = 0, all = 0, inside = -1;
  for (const Stage& s : stages) {
    if (stage.starts_with(s.begins) && stage.find(s.contains) != std::string::npos) {
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
