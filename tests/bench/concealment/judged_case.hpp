#pragma once
/// One verdict against its truth.
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace repose::concealment {

struct JudgedCase {
  std::string id, level, family, backend, sensor;
  std::vector<std::string> truth;    ///< names; ["unknown"] for an effect outside the library; empty: nothing
  std::vector<std::string> answer;   ///< first hypothesis; ["unknown"]; empty: nothing missing
  std::string word;                  ///< verdict
  double signal = 0;
  double wall_s = 0;
  bool detectable = true;            ///< the oracle gains at least ln 100 on held-out runs; with nothing or the unknown concealed always true
  bool right_first = false;          ///< the answer is the truth
  bool within_set = false;           ///< every true name is in the answer or in a class with it
  bool ambiguous = false;
  std::optional<bool> confounded;    ///< a rival of the same size fits held-out runs as well as the truth, within 2 nats
  std::optional<bool> separated;     ///< with the recording that an ambiguous verdict asked for the truth is named, alone
  std::optional<bool> phase_right;   ///< of the first location
  std::optional<double> overlap;     ///< intersection over union of the first location with the true times in its run
  std::optional<double> coefficient_error;  ///< |estimate - truth| / |truth - null| if the name is right
  std::optional<bool> covered;              ///< the 90 % interval holds the truth
  std::optional<double> gain_share;         ///< of the oracle's held-out gain
  double top_probability = 0;
  double brier = 0;                  ///< sum over ranked hypotheses of (p - [it is the truth])^2
  double heldout_nominal = 0, heldout_extended = 0;  ///< chi^2 per degree of freedom
  std::string regression;            ///< what sparse regression says; empty: nothing
};

/// `verdict`, `oracle`, `suggested`: as concealment_diagnose wrote them ("observables" of the file). The latter two may be null.
JudgedCase judge(const std::string& id, const nlohmann::json& truth, const nlohmann::json& verdict, const nlohmann::json& oracle,
                 const nlohmann::json& suggested);

}  // namespace repose::concealment
