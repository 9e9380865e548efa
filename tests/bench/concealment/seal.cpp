#include "tests/bench/concealment/seal.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>

#include "core/atomic_file.hpp"
#include "core/error.hpp"

namespace repose::concealment {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json read_json(const fs::path& file) {
  json content = json::parse(read_bytes(file), nullptr, false);
  if (content.is_discarded()) throw Error(file.string(), "is not JSON", "generate the benchmark anew");
  return content;
}

fs::path truth_file(const fs::path& folder) { return folder / "sealed" / "truth.json"; }
fs::path opening_file(const fs::path& folder) { return folder / "opened.json"; }

json opening_of(const fs::path& folder, const json& manifest, bool partly) {
  json verdicts = json::object();
  for (const std::string& id : case_ids(manifest)) {
    const fs::path file = verdict_file(folder, id);
    if (fs::exists(file))
      verdicts[id] = sha256(read_bytes(file));
    else if (!partly)
      throw Error(file.string(), "this case has no verdict yet", "diagnose all cases first, or give --partly: what has no verdict now is never scored");
  }
  return {{"truth_sha256", manifest.at("truth_sha256")}, {"verdicts", verdicts}};
}

}  // namespace

std::string sha256(const std::string& bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1)
    throw Error("SHA-256", "OpenSSL refuses", "", Error::Kind::simulation);
  std::string text;
  for (unsigned i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
  return text;
}

json read_manifest(const fs::path& folder) {
  if (!fs::exists(folder / "manifest.json"))
    throw Error(folder.string(), "holds no manifest.json", "make the cases with concealment_generate");
  return read_json(folder / "manifest.json");
}

std::vector<std::string> case_ids(const json& manifest) { return manifest.at("cases").get<std::vector<std::string>>(); }

fs::path verdict_file(const fs::path& folder, const std::string& id) { return folder / "verdicts" / "jobs" / (id + ".json"); }

void seal(const fs::path& folder, const json& truth, json manifest) {
  const std::string text = truth.dump(1) + "\n";
  fs::create_directories(truth_file(folder).parent_path());
  write_durably(truth_file(folder), text);
  manifest["truth_sha256"] = sha256(text);
  write_durably(folder / "manifest.json", manifest.dump(1) + "\n");
}

json open_seal(const fs::path& folder, bool partly) {
  const json manifest = read_manifest(folder);
  const std::string text = read_bytes(truth_file(folder));
  if (sha256(text) != manifest.at("truth_sha256"))
    throw Error(truth_file(folder).string(), "is not the truth whose SHA-256 the manifest states", "these verdicts cannot be scored; generate anew");
  if (!is_open(folder)) write_durably(opening_file(folder), opening_of(folder, manifest, partly).dump(1) + "\n");
  const json opening = read_json(opening_file(folder));
  for (const std::string& id : case_ids(manifest)) {
    const fs::path file = verdict_file(folder, id);
    const bool there = fs::exists(file), known = opening.at("verdicts").contains(id);
    if (there != known || (there && sha256(read_bytes(file)) != opening.at("verdicts").at(id)))
      throw Error(file.string(), "this verdict is younger than the opening of the truth", "generate new cases from another seed");
  }
  return json::parse(text);
}

bool is_open(const fs::path& folder) { return fs::exists(opening_file(folder)); }

}  // namespace repose::concealment
