#pragma once
/// diagnosis.json and the headline in words.
#include <string>

#include <nlohmann/json.hpp>

#include "analysis/diagnosis/diagnose.hpp"

namespace repose {

nlohmann::json diagnosis_json(const diagnosis::Diagnosis& d);

/// What was found, in two or three sentences.
std::string diagnosis_in_words(const diagnosis::Diagnosis& d);

}  // namespace repose
