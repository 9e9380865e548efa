#pragma once
/// What diagnosis.json must be: keys, kinds and meanings. For tests of whoever writes one.
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/effect_library.hpp"

namespace repose::test {

using nlohmann::json;

inline const std::set<std::string> verdicts = {"missing", "none", "unknown", "ambiguous", "measurement", "numerics"};
inline const std::set<std::string> phases = {"flight", "impact", "sliding", "rolling", "rest", "flow", "heap", "spread"};
inline const std::set<std::string> variables = {"speed", "slip_speed",  "normal_force", "spin", "position",    "height",
                                                "time",  "temperature", "direction",    "size", "impact_speed"};

inline bool is_share(const json& v) { return v.is_number() && v.get<double>() >= 0 && v.get<double>() <= 1; }

/// `least`: what so many replicas can show.
inline bool is_p(const json& v, double least) { return is_share(v) && v.get<double>() >= least - 1e-12; }

/// None, a name, or rings of a profile [m].
inline bool is_region(const json& v) {
  if (!v.is_object()) return v.is_null() || v.is_string();
  return v.contains("radius_from") && v.contains("radius_to") && v["radius_from"].is_number() && v["radius_to"].is_number() && v["radius_from"] < v["radius_to"];
}

/// A stretch of time; of many grains none where no time was recorded.
inline bool is_stretch(const json& from, const json& to, bool of_grains) {
  if (of_grains && from.is_null() && to.is_null()) return true;
  return from.is_number() && to.is_number() && from <= to;
}

inline void check_interval(const json& v, const std::string& name, std::vector<std::string>& faults) {
  if (!v["value"].is_number() || !v["lower"].is_number() || !v["upper"].is_number())
    faults.push_back(name + ": value, lower, upper");
  else if (v["lower"] > v["value"] || v["value"] > v["upper"])
    faults.push_back(name + ": lower <= value <= upper");
}

inline void check_fit(const json& fit, const std::string& name, std::vector<std::string>& faults) {
  if (!fit["runs"].is_array()) faults.push_back(name + ".runs");
  for (const char* model : {"nominal", "extended"}) {
    if (fit["runs"].empty()) continue;
    if (!fit[model]["chi2_per_dof"].is_number()) faults.push_back(name + "." + model + ".chi2_per_dof");
    if (!fit[model]["rmse"].is_object() || fit[model]["rmse"].empty()) faults.push_back(name + "." + model + ".rmse");
    for (const auto& [observable, rmse] : fit[model]["rmse"].items())
      if (!rmse.is_number() || rmse < 0) faults.push_back(name + "." + model + ".rmse." + observable);
  }
}

inline void check_where(const json& where, double least_p, bool of_grains, std::vector<std::string>& faults) {
  double last = 0;
  for (const json& w : where) {
    for (const char* key : {"observable", "body", "run"})
      if (!w[key].is_string()) faults.push_back(std::string("where.") + key);
    if (!phases.contains(w.value("phase", ""))) faults.push_back("where.phase");
    if (!w.contains("region") || !is_region(w["region"])) faults.push_back("where.region");
    if (!w.contains("t_start") || !w.contains("t_end") || !is_stretch(w["t_start"], w["t_end"], of_grains)) faults.push_back("where.t_start");
    if (!is_p(w["p"], least_p)) faults.push_back("where.p");
    if (w["p"] < last) faults.push_back("where is sorted by p");
    last = w["p"];
  }
}

inline void check_ranked(const json& result, std::vector<std::string>& faults) {
  double total = 0;
  bool nothing = false, unknown = false;
  for (const json& r : result["ranked"]) {
    if (!r["effects"].is_array() || !is_share(r["probability"])) faults.push_back("ranked");
    total += r["probability"].get<double>();
    nothing = nothing || r["effects"].empty();
    unknown = unknown || r["effects"] == json{"unknown"};
  }
  if (std::abs(total - 1) > 1e-9) faults.push_back("probabilities sum to 1");
  if (!nothing) faults.push_back("ranked has []");
  if (!unknown) faults.push_back("ranked has [\"unknown\"]");
}

/// What is wrong with a diagnosis.json; empty: nothing.
inline std::vector<std::string> faults_of(json result) {
  std::vector<std::string> faults;
  for (const char* key : {"verdict", "missing", "ranked", "indistinguishable", "suggested_recordings", "where", "depends_on", "nominal", "fit", "extended_scene", "compared"})
    if (!result.contains(key)) faults.push_back(std::string("no key ") + key);
  if (!faults.empty()) return faults;
  const std::string verdict = result["verdict"];
  if (!verdicts.contains(verdict)) faults.push_back("verdict");
  const bool names = verdict != "none" && verdict != "unknown";
  if (result["missing"].empty() == names) faults.push_back("missing names effects exactly if the verdict does");
  for (const json& m : result["missing"]) {
    if (find_effect(m.value("effect", "")) == nullptr || !is_share(m["probability"])) faults.push_back("missing");
    for (const auto& [name, value] : m["parameters"].items()) {
      check_interval(value, name, faults);
      if (!value["unit"].is_string()) faults.push_back(name + ".unit");
    }
  }
  check_ranked(result, faults);
  for (const json& group : result["indistinguishable"])
    if (group.size() < 2 || group.size() > 3) faults.push_back("indistinguishable: two or three");
  if ((verdict == "ambiguous") == result["indistinguishable"].empty()) faults.push_back("ambiguous has a class, others none");
  for (const json& s : result["suggested_recordings"])
    if (!s["what"].is_string() || s["separates"].size() != 2 || s["separates"][0] == s["separates"][1] || !is_share(s["power"]))
      faults.push_back("suggested_recordings");
  for (const json& s : result["depends_on"])
    if (!variables.contains(s.value("variable", "")) || !is_share(s["explained"])) faults.push_back("depends_on");
  const json& nominal = result["nominal"];
  // Of many grains p is of a known distribution, and may be as small as it likes.
  const bool of_grains = nominal.value("null", "") == "packings";
  const bool counted = nominal["replicas"].is_number_integer() && nominal["replicas"] > 0;
  if (!counted) faults.push_back("nominal.replicas");
  const double least_p = of_grains || !counted ? 0 : 1.0 / (nominal["replicas"].get<int>() + 1);
  if (!nominal["calibrated"].is_object() || !is_p(nominal["lack_of_fit_p"], least_p)) faults.push_back("nominal");
  for (const auto& [name, value] : nominal["calibrated"].items()) check_interval(value, name, faults);
  check_where(result["where"], least_p, of_grains, faults);
  check_fit(result["fit"]["train"], "fit.train", faults);
  check_fit(result["fit"]["heldout"], "fit.heldout", faults);
  if (!is_share(result["fit"]["heldout"]["paired_p"]) || !result["fit"]["heldout"]["effect_size"].is_number()) faults.push_back("fit.heldout.paired_p");
  for (const json& c : result["compared"])
    if (!c["run"].is_string() || !c["until"].is_number() || c["until"] > c["recorded_until"]) faults.push_back("compared");
  if (result["extended_scene"] != "extended.yaml") faults.push_back("extended_scene");
  return faults;
}

}  // namespace repose::test
