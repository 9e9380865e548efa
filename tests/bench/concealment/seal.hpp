#pragma once
/// Labels under seal. A benchmark is a folder:
///
///   manifest.json     what anybody may know: the cases' names, and the SHA-256 of the truth
///   cases/<id>/       bundles
///   sealed/truth.json the truth; read by the scorer alone
///   verdicts/, oracle/  what the diagnosis said, as jobs/<id>.json
///   opened.json       the SHA-256 of every verdict that was there when the seal was broken
///
/// A verdict that is not in opened.json, or not the same any more, is younger than the opening and is refused.
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace repose::concealment {

/// In hexadecimal digits (OpenSSL).
std::string sha256(const std::string& bytes);

/// Throws Error if the folder holds no manifest.
nlohmann::json read_manifest(const std::filesystem::path& folder);
std::vector<std::string> case_ids(const nlohmann::json& manifest);

std::filesystem::path verdict_file(const std::filesystem::path& folder, const std::string& id);

/// Writes the truth, then the manifest last of all. `truth`: by case.
void seal(const std::filesystem::path& folder, const nlohmann::json& truth, nlohmann::json manifest);

/// The truth by case. Breaks the seal the first time: then every case needs its verdict, unless `partly`. Throws Error if the
/// truth is not the one that was sealed, or a verdict is younger than the opening.
nlohmann::json open_seal(const std::filesystem::path& folder, bool partly);

bool is_open(const std::filesystem::path& folder);

}  // namespace repose::concealment
