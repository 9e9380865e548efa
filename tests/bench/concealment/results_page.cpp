#include "tests/bench/concealment/results_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "tests/bench/concealment/concealed_case.hpp"
#include "tests/bench/concealment/measures.hpp"

namespace repose::concealment {
namespace {

using Cases = std::vector<JudgedCase>;
using Which = std::function<bool(const JudgedCase&)>;

std::string label(const std::vector<std::string>& names) { return names.empty() ? "none" : fmt::format("{}", fmt::join(names, " + ")); }

Estimate share_of(const Cases& cases, const Which& among, const Which& hit) {
  std::size_t n = 0, hits = 0;
  for (const JudgedCase& c : cases)
    if (among(c)) ++n, hits += hit(c);
  return share(hits, n);
}

template <class Value>
std::vector<double> values(const Cases& cases, const Which& among, Value value) {
  std::vector<double> list;
  for (const JudgedCase& c : cases)
    if (among(c))
      if (const auto v = value(c); v && std::isfinite(static_cast<double>(*v))) list.push_back(static_cast<double>(*v));
  return list;
}

double median(std::vector<double> sample) { return quantile(std::move(sample), 0.5); }
double tenth(std::vector<double> sample) { return quantile(std::move(sample), 0.1); }
double mean(const std::vector<double>& sample) {
  double sum = 0;
  for (const double v : sample) sum += v;
  return sum / static_cast<double>(sample.size());
}

bool of_library(const JudgedCase& c) { return !c.truth.empty() && c.level != "unknown"; }
bool plain_level(const JudgedCase& c) { return of_library(c) && (c.level == "C0" || c.level == "C1" || c.level == "C2"); }
Which detectable(const Which& among) {
  return [=](const JudgedCase& c) { return among(c) && c.detectable; };
}
Which on(const std::string& level) {
  return [=](const JudgedCase& c) { return c.level == level && of_library(c); };
}
bool right(const JudgedCase& c) { return c.right_first; }

std::string row(const std::string& what, const std::string& target, const Estimate& e, int decimals = 2) {
  return fmt::format("| {} | {} | {} | {} |\n", what, target, e.n, text_of(e, decimals));
}

std::string measures_table(const Cases& cases) {
  const auto nominal = [](const JudgedCase& c) { return c.level == "nominal"; };
  const auto foreign = [](const JudgedCase& c) { return c.level == "C4" && c.truth.empty(); };
  const auto known = detectable(of_library), plain = detectable(plain_level);
  const auto located = [&](const JudgedCase& c) { return known(c) && c.phase_right.has_value(); };
  const auto overlapped = [&](const JudgedCase& c) { return (known(c) || c.level == "unknown") && c.overlap.has_value(); };
  const auto sized = [&](const JudgedCase& c) { return known(c) && c.coefficient_error.has_value() && c.truth.size() == 1; };
  std::string t = "| measure | target | n | reached (95 % interval) |\n|---|---|---|---|\n";
  t += row("false alarms on nominal recordings, whatever is said", "1 %, bound 4 %", share_of(cases, nominal, [](const JudgedCase& c) { return c.word != "none"; }));
  t += row("`numerics` said of nominal recordings (among the above)", "false alarm", share_of(cases, nominal, [](const JudgedCase& c) { return c.word == "numerics"; }));
  t += row("nominal C4: neither `none` nor `numerics`", "false alarm",
           share_of(cases, foreign, [](const JudgedCase& c) { return c.word != "none" && c.word != "numerics"; }));
  t += row("right name first, detectable, C0 to C2", "≥ 0.90", share_of(cases, plain, right));
  for (const char* level : {"C0", "C1", "C2"}) t += row(fmt::format("– {}", level), "", share_of(cases, detectable(on(level)), right));
  t += row("true name within the reported set, C0 to C2", "≥ 0.97", share_of(cases, plain, [](const JudgedCase& c) { return c.within_set; }));
  t += row("right name first, detectable, C4", "≥ 0.80", share_of(cases, detectable(on("C4")), right));
  t += row("both names, C3", "≥ 0.75", share_of(cases, detectable(on("C3")), right));
  t += row("– one of the two, C3", "", share_of(cases, detectable(on("C3")), [](const JudgedCase& c) {
             return std::any_of(c.truth.begin(), c.truth.end(), [&](const std::string& n) { return std::find(c.answer.begin(), c.answer.end(), n) != c.answer.end(); });
           }));
  t += row("`unknown` when the effect is outside the library", "≥ 0.90", share_of(cases, [](const JudgedCase& c) { return c.level == "unknown"; }, right));
  t += row("known effects called unknown", "≤ 0.05", share_of(cases, known, [](const JudgedCase& c) { return c.word == "unknown"; }));
  t += row("located: phase right", "≥ 0.90", share_of(cases, located, [](const JudgedCase& c) { return *c.phase_right; }));
  t += row("located: overlap with the true times, median", "≥ 0.6", bootstrapped(values(cases, overlapped, [](const JudgedCase& c) { return c.overlap; }), median));
  t += row("coefficient: relative error, median", "≤ 0.05", bootstrapped(values(cases, sized, [](const JudgedCase& c) { return c.coefficient_error; }), median), 3);
  t += row("coefficient: 90 % interval covers", "0.86 to 0.94", share_of(cases, sized, [](const JudgedCase& c) { return *c.covered; }));
  const std::vector<double> gains = values(cases, known, [](const JudgedCase& c) { return c.gain_share; });
  t += row("held-out gain, share of the oracle's, median", "≥ 0.95", bootstrapped(gains, median));
  t += row("held-out gain, share of the oracle's, 10th percentile", "≥ 0.80", bootstrapped(gains, tenth));
  const auto confounded = [&](const JudgedCase& c) { return known(c) && c.confounded.value_or(false); };
  const auto separable = [&](const JudgedCase& c) { return known(c) && !c.confounded.value_or(true); };
  t += row("confounded pairs admitted", "≥ 0.95", share_of(cases, confounded, [](const JudgedCase& c) { return c.ambiguous; }));
  t += row("– the recording that they ask for separates them", "≥ 0.80",
           share_of(cases, [&](const JudgedCase& c) { return confounded(c) && c.separated.has_value(); }, [](const JudgedCase& c) { return *c.separated; }));
  t += row("separable pairs called confounded", "≤ 0.05", share_of(cases, separable, [](const JudgedCase& c) { return c.ambiguous; }));
  const auto judged = [](const JudgedCase& c) { return !of_library(c) || c.detectable; };
  t += row("Brier score, summed over the hypotheses", "stated", bootstrapped(values(cases, judged, [](const JudgedCase& c) { return std::optional(c.brier); }), mean));
  t += row("not detectable: answered `none`", "–", share_of(cases, [](const JudgedCase& c) { return of_library(c) && !c.detectable; },
                                                               [](const JudgedCase& c) { return c.word == "none"; }));
  t += row("not detectable: another name than the true one", "–", share_of(cases, [](const JudgedCase& c) { return of_library(c) && !c.detectable; },
                                                               [](const JudgedCase& c) { return !c.within_set && c.word != "none" && c.word != "unknown"; }));
  return t;
}

std::string reliability_table(const Cases& cases) {
  std::string t = "| stated probability of the answer | n | mean stated | right (95 % interval) |\n|---|---|---|---|\n";
  const double edges[] = {0, 0.5, 0.8, 0.95, 0.99, 1.0001};
  for (std::size_t i = 0; i + 1 < std::size(edges); ++i) {
    const auto within = [&](const JudgedCase& c) {
      return (!of_library(c) || c.detectable) && c.word != "failed" && c.top_probability >= edges[i] && c.top_probability < edges[i + 1];
    };
    const std::vector<double> stated = values(cases, within, [](const JudgedCase& c) { return std::optional(c.top_probability); });
    t += fmt::format("| {} to {} | {} | {} | {} |\n", edges[i], std::min(1.0, edges[i + 1]), stated.size(), stated.empty() ? "–" : fmt::format("{:.3f}", mean(stated)),
                     text_of(share_of(cases, within, right)));
  }
  return t;
}

std::string baselines_table(const Cases& cases) {
  const auto plain = detectable(plain_level);
  const auto nominal = [](const JudgedCase& c) { return c.level == "nominal"; };
  const auto regressed = [](const JudgedCase& c) { return c.regression.empty() ? std::vector<std::string>{} : std::vector<std::string>{c.regression}; };
  const auto chi = [&](bool extended) {
    return bootstrapped(values(cases, plain, [&](const JudgedCase& c) { return std::optional(extended ? c.heldout_extended : c.heldout_nominal); }), median);
  };
  std::string t = "| | right name first, C0 to C2 | false alarms, nominal | held-out χ² per degree of freedom, median |\n|---|---|---|---|\n";
  t += fmt::format("| calibration only | {} | {} | {} |\n", text_of(share_of(cases, plain, [](const JudgedCase&) { return false; })),
                   text_of(share_of(cases, nominal, [](const JudgedCase&) { return false; })), text_of(chi(false)));
  t += fmt::format("| sparse regression on derivatives | {} | {} | – |\n", text_of(share_of(cases, plain, [&](const JudgedCase& c) { return regressed(c) == c.truth; })),
                   text_of(share_of(cases, nominal, [&](const JudgedCase& c) { return !c.regression.empty(); })));
  t += fmt::format("| repose diagnose | {} | {} | {} |\n", text_of(share_of(cases, plain, right)),
                   text_of(share_of(cases, nominal, [](const JudgedCase& c) { return c.word != "none"; })), text_of(chi(true)));
  return t;
}

std::string confusion_table(const Cases& cases) {
  std::map<std::string, std::map<std::string, int>> counts;
  std::map<std::string, int> totals;
  for (const JudgedCase& c : cases) {
    if (of_library(c) && !c.detectable) continue;
    ++counts[label(c.truth)][label(c.answer) + (c.ambiguous ? " (ambiguous)" : "")];
    ++totals[label(c.truth)];
  }
  std::string t = "| truth | n | answers |\n|---|---|---|\n";
  for (const auto& [truth, answers] : counts) {
    std::string list;
    for (const auto& [answer, n] : answers) list += fmt::format("{}{} × {}", list.empty() ? "" : ", ", n, answer);
    t += fmt::format("| {} | {} | {} |\n", truth, totals[truth], list);
  }
  return t;
}

std::string case_table(const Cases& cases) {
  std::string t = "| case | level | family | engine | sensor | signal [σ] | truth | answer | verdict | oracle | s |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const JudgedCase& c : cases)
    t += fmt::format("| {} | {} | {} | {} | {} | {:.1f} | {} | {} | {} | {} | {:.0f} |\n", c.id, c.level, c.family, c.backend, c.sensor, c.signal, label(c.truth),
                     label(c.answer), c.word, of_library(c) ? (c.detectable ? "detectable" : "not detectable") : "–", c.wall_s);
  return t;
}

}  // namespace

std::string results_page(const Cases& cases, const std::vector<std::string>& told) {
  double wall = 0;
  for (const JudgedCase& c : cases) wall += c.wall_s;
  std::string page = "# Concealment benchmark: results\n\n";
  for (const std::string& line : told) page += line + "\n";
  page += fmt::format("{} cases, {:.0f} s of wall time in all. Intervals: Clopper & Pearson for shares, bootstrap for the rest. Detectable: the model that is told "
                      "the truth gains at least ln 100 nats on held-out runs.\n\n", cases.size(), wall);
  page += "## Measures\n\n" + measures_table(cases);
  page += "\nConfounded: a rival of as many effects reaches the truth's held-out log likelihood within 2 nats. The recording that an ambiguous verdict asks for "
          "is made in the true world, all runs once more, and diagnosed with what there was: it separates if the truth is then named alone.\n";
  page += "\n## Reliability\n\nAll but what the oracle calls not detectable.\n\n" + reliability_table(cases);
  page += "\n## Baselines\n\n" + baselines_table(cases);
  page += "\n## Answers by truth\n\n" + confusion_table(cases);
  page += "\n## Cases\n\n" + case_table(cases);
  return page;
}

}  // namespace repose::concealment
