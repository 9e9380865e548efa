#include "scenarios/compare_verdict.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/statistics.hpp"
#include "analysis/two_samples.hpp"

namespace repose {
namespace {

using nlohmann::json;

constexpr Refinement finer[] = {Refinement::half_step, Refinement::tenth_tolerance};

json finite(double x) { return std::isfinite(x) ? json(x) : json(nullptr); }

// A difference with or without scatter.
struct Difference {
  std::size_t n = 0;
  MeanDifference d;
  bool scatter() const { return n >= 2; }
};

Difference difference_of(const CompareResults::Pairs& pairs) {
  Difference r;
  r.n = pairs.first.size();
  if (r.n >= 2)
    r.d = paired_difference(pairs.first, pairs.second);
  else if (r.n == 1)
    r.d = {pairs.first[0] - pairs.second[0], 0, 0, 0, 1};
  return r;
}

std::string told(double value, const std::string& unit) { return fmt::format("{:.3g}{}", value, unit == "1" ? "" : " " + unit); }

// Of one pair of backends and one observable.
struct Pair {
  std::size_t a = 0, b = 0;
  Difference difference;
  double corrected = 1;
  bool differ = false;
  bool one_sided = false;  // one of them has no value at all
};

struct Entry {
  std::string name;
  json description;
  std::vector<Pair> pairs;
  double resolution = 0;
};

class Judge {
 public:
  Judge(const Comparison& comparison, const CompareResults& results) : c_(comparison), r_(results) {}

  json verdicts() {
    for (const std::string& name : r_.observables()) entries_.push_back(entry_of(name));
    std::erase_if(entries_, [&](const Entry& e) { return nobody_has(e.name); });
    for (const char* kind : {"physics", "quality", "cost"}) correct(kind);
    json all = json::array();
    for (const Entry& e : entries_) all.push_back(entry_json(e));
    return all;
  }

 private:
  bool nobody_has(const std::string& name) const {
    for (std::size_t k = 0; k < c_.contenders.size(); ++k)
      if (!r_.values(k, Refinement::none, name).empty()) return false;
    return true;
  }

  Entry entry_of(const std::string& name) const {
    Entry e{name, r_.description(name), {}, 0};
    e.resolution = c_.tolerance * e.description["scale"].get<double>();
    for (std::size_t a = 0; a < c_.contenders.size(); ++a)
      for (std::size_t b = a + 1; b < c_.contenders.size(); ++b) {
        Pair pair{a, b, difference_of(r_.paired(a, Refinement::none, b, Refinement::none, name)), 1, false, false};
        pair.one_sided = pair.difference.n == 0 && r_.values(a, Refinement::none, name).empty() != r_.values(b, Refinement::none, name).empty();
        e.pairs.push_back(pair);
      }
    return e;
  }

  void correct(const std::string& kind) {
    std::vector<Pair*> family;
    std::vector<double> p;
    for (Entry& e : entries_)
      for (Pair& pair : e.pairs) {
        if (e.description["kind"] != kind) continue;
        if (pair.difference.scatter()) {
          family.push_back(&pair);
          p.push_back(pair.difference.d.p);
        }
      }
    const std::vector<double> corrected = holm(p);
    for (std::size_t i = 0; i < family.size(); ++i) family[i]->corrected = corrected[i];
    for (Entry& e : entries_)
      for (Pair& pair : e.pairs) {
        if (e.description["kind"] != kind) continue;
        const bool beyond = std::abs(pair.difference.d.value) > e.resolution;
        pair.differ = pair.one_sided || (beyond && (pair.difference.scatter() ? pair.corrected < compare_alpha : pair.difference.n == 1));
      }
  }

  // Refined minus not refined.
  Difference shift(std::size_t k, Refinement how, const std::string& name) const {
    return difference_of(r_.paired(k, how, k, Refinement::none, name));
  }
  static bool significant(const Difference& d) { return d.scatter() ? d.d.p < compare_alpha : d.n == 1 && d.d.value != 0; }

  json refinement_json(const Entry& e) const {
    json all = json::object();
    for (std::size_t k = 0; k < c_.contenders.size(); ++k)
      for (Refinement how : finer) {
        const Difference s = shift(k, how, e.name);
        if (s.n == 0) continue;
        all[c_.contenders[k].label][refinement_key(how)] = {
            {"shift", s.d.value}, {"se", s.scatter() ? json(s.d.se) : json(nullptr)}, {"p", s.scatter() ? json(s.d.p) : json(nullptr)}};
      }
    return all;
  }

  // What a difference may be blamed on; `text` grows by sentences.
  json explanation(const Entry& e, const Pair& pair, std::string& text) const {
    const std::string unit = e.description["unit"];
    json by = json::array();
    double largest = 0;
    bool refined = false;
    for (std::size_t k : {pair.a, pair.b})
      for (Refinement how : finer) {
        const Difference s = shift(k, how, e.name);
        if (s.n == 0) continue;
        refined = true;
        largest = std::max(largest, std::abs(s.d.value));
        if (!significant(s) || std::abs(s.d.value) < std::abs(pair.difference.d.value) / 2) continue;
        const bool whole = std::abs(s.d.value) >= std::abs(pair.difference.d.value);
        if (whole) by.push_back({{"backend", c_.contenders[k].label}, {"refinement", refinement_key(how)}});
        text += fmt::format(" {} is not converged in {}: its value moves by {} under {}{}.", c_.contenders[k].label,
                            how == Refinement::half_step ? "h" : "tolerance", told(s.d.value, unit), refinement_label(how),
                            whole ? ", as much as the difference" : "");
      }
    if (!refined)
      text += " Refinement was not run, so step and tolerance are not ruled out.";
    else if (by.empty() && largest < std::abs(pair.difference.d.value) / 2)
      text += fmt::format(" Not a matter of step or tolerance: refinement moves neither by more than {}.", told(largest, unit));
    return by;
  }

  json pair_json(const Entry& e, const Pair& pair, std::string& text) const {
    const Difference& d = pair.difference;
    const std::string &a = c_.contenders[pair.a].label, &b = c_.contenders[pair.b].label, unit = e.description["unit"];
    json j = {{"a", a}, {"b", b}, {"n", d.n}, {"verdict", pair.differ ? "differ" : "agree"}};
    if (pair.one_sided) {
      text += fmt::format(" Only one of {} and {} has a value.", a, b);
      return j;
    }
    if (d.n == 0) return j;
    j["difference"] = d.d.value;
    j["resolution"] = e.resolution;
    j["statistic"] = d.scatter() ? "paired" : "none";
    j["se"] = d.scatter() ? json(d.d.se) : json(nullptr);
    j["standard_errors"] = d.scatter() ? finite(std::abs(d.d.t)) : json(nullptr);
    if (d.scatter()) {
      j["half_width_95"] = d.d.se * student_t_quantile(0.975, static_cast<int>(d.n) - 1);
      j["p"] = d.d.p;
      j["p_corrected"] = pair.corrected;
      const auto x = r_.values(pair.a, Refinement::none, e.name), y = r_.values(pair.b, Refinement::none, e.name);
      j["welch_standard_errors"] = finite(std::abs(welch_difference(x, y).t));
    }
    for (Refinement how : finer) {
      const Difference refined = difference_of(r_.paired(pair.a, how, pair.b, how, e.name));
      if (refined.n > 0)
        j["refined"][refinement_key(how)] = {{"difference", refined.d.value}, {"se", refined.scatter() ? json(refined.d.se) : json(nullptr)},
                                             {"standard_errors", refined.scatter() ? finite(std::abs(refined.d.t)) : json(nullptr)}};
    }
    if (!pair.differ) return j;
    text += fmt::format(" {} - {} = {}", a, b, told(d.d.value, unit));
    if (d.scatter() && std::isfinite(d.d.t))
      text += fmt::format(": {:.1f} standard errors (paired by seed, p = {:.2g} after Holm).", std::abs(d.d.t), pair.corrected);
    else
      text += fmt::format(": more than the tolerance of {}; no scatter to compare with.", told(e.resolution, unit));
    if (e.description["kind"] == "physics") j["explained_by"] = explanation(e, pair, text);
    return j;
  }

  json entry_json(const Entry& e) const {
    json j = {{"name", e.name}, {"unit", e.description["unit"]}, {"kind", e.description["kind"]}, {"values", json::object()}};
    for (std::size_t k = 0; k < c_.contenders.size(); ++k) {
      const Summary s = summarise(r_.values(k, Refinement::none, e.name));
      const json scatter = s.n > 1 ? json(s.se) : json(nullptr);
      j["values"][c_.contenders[k].label] = {{"mean", s.n > 0 ? json(s.mean) : json(nullptr)}, {"se", scatter},
                                             {"sd", s.n > 1 ? json(s.sd) : json(nullptr)}, {"n", s.n}};
    }
    std::string text;
    bool differ = false;
    json most = nullptr, pairs = json::array();
    for (const Pair& pair : e.pairs) {
      pairs.push_back(pair_json(e, pair, text));
      differ = differ || pair.differ;
      if (const json& t = pairs.back().value("standard_errors", json()); t.is_number() && (most.is_null() || t > most)) most = t;
    }
    j["verdict"] = differ ? "differ" : "agree";
    j["standard_errors"] = most;
    j["text"] = differ ? text.substr(1) : "";
    j["pairs"] = pairs;
    j["refinement"] = refinement_json(e);
    return j;
  }

  const Comparison& c_;
  const CompareResults& r_;
  std::vector<Entry> entries_;
};

}  // namespace

const char* refinement_label(Refinement refinement) {
  switch (refinement) {
    case Refinement::none: return "as given";
    case Refinement::half_step: return "h/2";
    case Refinement::tenth_tolerance: return "tolerance/10";
  }
  return "";
}

const char* refinement_key(Refinement refinement) {
  switch (refinement) {
    case Refinement::none: return "none";
    case Refinement::half_step: return "half_step";
    case Refinement::tenth_tolerance: return "tenth_tolerance";
  }
  return "";
}

json compare_verdicts(const Comparison& comparison, const CompareResults& results) { return Judge(comparison, results).verdicts(); }

}  // namespace repose
