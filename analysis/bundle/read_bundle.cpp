#include "analysis/bundle/read_bundle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <string_view>

#include "analysis/bundle/bundle_files.hpp"
#include "analysis/bundle/bundle_units.hpp"
#include "analysis/bundle/numeric_key.hpp"
#include "analysis/bundle/scene_keys.hpp"
#include "analysis/bundle/windows.hpp"
#include "core/error.hpp"
#include "core/yaml_tree.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;

/// A key whose value is a number or a list of numbers, in a named part of the scene that exists.
void check_key(const YamlReader& reader, const std::string& key, const std::string& text, const YamlNode& tree,
               const std::string& scene_file) {
  constexpr std::string_view orientation = ".orientation.";
  if (const std::size_t at = key.rfind(orientation); at != std::string::npos && at + orientation.size() + 1 == key.size())
    reader.fail("one component of an orientation cannot change alone", fmt::format("name the whole: `{}`", key.substr(0, key.size() - 2)));
  YamlNode changed = tree;
  try {
    const YamlNode* present = node_at(tree, key);
    set_path(changed, key, present == nullptr || present->kind == YamlNode::Kind::null ? text : emit_yaml(*present));
    const Scene ignored = parse_scene(emit_yaml(changed), scene_file, {}, fs::path(scene_file).parent_path());
  } catch (const Error& problem) {
    reader.fail(fmt::format("the scene has no such key, or not of that kind: {}", problem.problem()), problem.remedy());
  }
}

/// What stands at a start value that the scene leaves out: a vector, an orientation, or one component of a vector
/// (`bodies.ball.velocity.2`).
std::string start_text(const std::string& key) {
  if (key.ends_with(".orientation")) return "[1, 0, 0, 0]";
  const bool component = key.size() > 2 && key[key.size() - 2] == '.' && key.back() >= '0' && key.back() <= '2';
  return component ? "0" : "[0, 0, 0]";
}

class BundleReader {
 public:
  BundleReader(const BundleFiles& files, const std::vector<Override>& overrides) : files_(files), overrides_(overrides) {}

  Bundle read() {
    const YamlNode tree = parse_yaml(files_.recording(), files_.recording_name());
    const YamlReader top(tree, files_.recording_name());
    top.only({"title", "source", "licence", "scene", "calibrate", "noise", "windows", "runs"});
    if (top.has("title")) bundle_.title = top.at("title").text();
    if (top.has("source")) bundle_.source = top.at("source").text();
    if (top.has("licence")) bundle_.licence = top.at("licence").text();
    read_scene(top.at("scene"));
    if (top.has("calibrate"))
      for (const YamlReader& item : top.at("calibrate").items()) {
        bundle_.calibrate.push_back(item.text());
        check_key(item, item.text(), "0.1", scene_tree_, bundle_.scene_file.string());
        check_numeric_key(item, item.text(), scene_tree_, false);
      }
    if (top.has("windows")) windows_ = top.at("windows").number(positive(dimension::time));
    const std::vector<YamlReader> runs = top.at("runs").items();
    if (runs.empty()) top.at("runs").fail("no runs", "a bundle holds one run at least");
    std::set<std::string> ids;
    for (const YamlReader& run : runs) read_run(run, ids);
    if (top.has("noise")) read_noise(top.at("noise"));
    if (bundle_.split_given &&
        std::all_of(bundle_.runs.begin(), bundle_.runs.end(), [](const BundleRun& r) { return r.held_out; }))
      top.at("runs").fail("every run is held out: nothing is left to fit", "set `held_out: false` for some");
    for (std::string& doubt : doubts_of(bundle_)) bundle_.warnings.push_back(std::move(doubt));
    // The tool's own split would put windows of one run on both sides.
    if (windows_ && !bundle_.split_given)
      top.at("windows").fail("windows of a run must not be judged by others of it", "set `held_out: true` for some runs");
    if (windows_) part_runs();
    return std::move(bundle_);
  }

 private:
  void read_scene(const YamlReader& reader) {
    bundle_.scene_file = files_.scene_name(reader.text());
    if (!files_.has_scene(reader.text()))
      reader.fail(fmt::format("there is no file {}", bundle_.scene_file.string()),
                  "the scene's file name is relative to recording.yaml");
    bundle_.scene =
        parse_scene(files_.scene(reader.text()), bundle_.scene_file.string(), overrides_, bundle_.scene_file.parent_path());
    scene_tree_ = parse_yaml(bundle_.scene.text, bundle_.scene_file.string());
  }

  void read_run(const YamlReader& reader, std::set<std::string>& ids) {
    reader.only({"id", "set", "free", "held_out", "from", "until", "observables"});
    BundleRun run;
    run.id = reader.at("id").text();
    if (!ids.insert(run.id).second)
      reader.at("id").fail(fmt::format("run `{}` is there twice", run.id), "give each run an id of its own");
    Scene scene = bundle_.scene;
    YamlNode tree = scene_tree_;
    if (reader.has("set")) {
      const YamlReader set = reader.at("set");
      if (set.node().kind != YamlNode::Kind::map)
        set.fail("expected a map of scene keys", "write `{bodies.ball.position: [0, 0, 1]}`");
      for (const YamlEntry& entry : set.node().entries) {
        const auto same = [&](const std::string& key) { return overlap(key, entry.key); };
        if (const auto free = std::find_if(bundle_.calibrate.begin(), bundle_.calibrate.end(), same); free != bundle_.calibrate.end())
          set.fail(fmt::format("the run sets `{}`, which `calibrate` leaves to one fit over all runs (`{}`)", entry.key, *free), "remove the key from one of the two");
        run.set.push_back({entry.key, emit_yaml(entry.value)});
        try {
          set_path(tree, entry.key, run.set.back().value);
        } catch (const Error& problem) {
          throw Error(fmt::format("{}:{}: {}.{}", files_.recording_name(), entry.line, set.path(), entry.key), problem.problem(),
                      problem.remedy());
        }
      }
      try {
        scene = parse_scene(emit_yaml(tree), bundle_.scene_file.string(), {}, bundle_.scene_file.parent_path());
      } catch (const Error& problem) {
        set.fail(fmt::format("with these keys the scene is refused: {}", problem.what()), "");
      }
    }
    if (reader.has("free"))
      for (const YamlReader& item : reader.at("free").items()) {
        run.free.push_back(item.text());
        check_key(item, item.text(), start_text(item.text()), tree, bundle_.scene_file.string());
        check_numeric_key(item, item.text(), tree, true);
      }
    if (reader.has("held_out")) {
      run.held_out = reader.at("held_out").flag();
      bundle_.split_given = bundle_.split_given || run.held_out;
    }
    const std::vector<YamlReader> observables = reader.at("observables").items();
    if (observables.empty()) reader.at("observables").fail("a run without observables", "leave the run out");
    for (const YamlReader& entry : observables) {
      Observation o = read_observation(entry, files_, scene);
      if (o.kind == ObservableKind::trajectory &&
          std::any_of(run.observations.begin(), run.observations.end(), [&](const Observation& other) { return other.kind == o.kind && other.body == o.body; }))
        entry.fail(fmt::format("a second trajectory of `{}`", o.body), "put positions and orientations of a body into one file, sorted by time");
      run.observations.push_back(std::move(o));
    }
    if (reader.has("from") || reader.has("until")) read_window(reader, run);
    if (windows_ && run.free.empty())
      reader.fail("`windows` begin anew, but this run has no `free` start values", "name its start values in `free`");
    check_scales(run, scene);
    for (std::string& doubt : doubtful_scales(run, scene)) bundle_.warnings.push_back(std::move(doubt));
    bundle_.runs.push_back(std::move(run));
  }

  void part_runs() {
    std::vector<BundleRun> whole;
    whole.swap(bundle_.runs);
    for (const BundleRun& run : whole)
      for (BundleRun& window : in_windows(run, *windows_)) bundle_.runs.push_back(std::move(window));
  }

  /// The part of the run that counts: samples outside it are dropped, and the scene's time 0 is its beginning.
  static void read_window(const YamlReader& reader, BundleRun& run) {
    if (reader.has("from")) run.from = reader.at("from").number(any(dimension::time));
    const double until =
        reader.has("until") ? reader.at("until").number(any(dimension::time)) : std::numeric_limits<double>::infinity();
    const YamlReader last = reader.at(reader.has("until") ? "until" : "from");
    if (!(until > run.from))
      last.fail(fmt::format("a window from {} s until {} s", run.from, until), "let `until` be later than `from`");
    for (Observation& o : run.observations) {
      if (o.kind != ObservableKind::trajectory && o.kind != ObservableKind::series) continue;
      cut(o, run.from, until);
      if (o.time.size() < 2)
        last.fail(fmt::format("{} holds {} samples between {} s and {} s", o.file, o.time.size(), run.from, until),
                  "choose a window with two samples at least");
    }
  }

  /// Noise of names that the runs have.
  void read_noise(const YamlReader& block) {
    std::set<std::string> names;
    for (const BundleRun& run : bundle_.runs)
      for (const Observation& o : run.observations) {
        names.insert(o.name);
        if (!o.orientation.empty()) names.insert("orientation");
      }
    block.only({names.begin(), names.end()});
    for (const auto& [name, reader] : block.named())
      bundle_.noise[name] = reader.number(positive(dimension_of(name)));
  }

  const BundleFiles& files_;
  const std::vector<Override>& overrides_;
  Bundle bundle_;
  std::optional<double> windows_;  // [s]
  YamlNode scene_tree_;
};

}  // namespace

Bundle read_bundle(const fs::path& path, const fs::path& root, const std::vector<Override>& overrides) {
  return BundleReader(*open_bundle_files(path, root), overrides).read();
}

}  // namespace repose
