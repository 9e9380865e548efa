#include "scenarios/record_block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "analysis/bundle/bundle_units.hpp"
#include "core/yaml_reader.hpp"
#include "core/yaml_tree.hpp"

namespace repose {
namespace {

std::string read_body(const YamlReader& reader, const Scene& scene) {
  std::vector<std::string> names;
  for (const SceneBody& body : scene.bodies)
    if (!body.fixed && !body.motion) names.push_back(body.name);
  const std::string name = reader.text();
  if (std::find(names.begin(), names.end(), name) != names.end()) return name;
  const Suggestion suggestion = suggest("no body that moves freely:", name, names);
  reader.fail(suggestion.problem, suggestion.remedy);
}

std::string read_name(const YamlReader& reader, const std::vector<std::string>& names) {
  const std::string name = reader.text();
  if (std::find(names.begin(), names.end(), name) != names.end()) return name;
  const Suggestion suggestion = suggest("cannot be recorded from a simulation:", name, names);
  reader.fail(suggestion.problem, suggestion.remedy);
}

/// What is recorded is written in SI, angles in degrees.
void read_unit(const YamlReader& entry, Observation& o) {
  const std::string unit = entry.at("unit").text();
  Observation one = o;
  one.unit = unit;
  one.value = {1};
  turn_into_si(entry, one);
  if (one.value[0] != 1) entry.at("unit").fail(fmt::format("`{}` is recorded in {}, not in {}", o.name, one.unit, unit), "leave `unit` out");
  o.unit = unit;
}

Observation read_observable(const YamlReader& entry, const Scene& scene) {
  Observation o;
  constexpr ObservableKind kinds[] = {ObservableKind::trajectory, ObservableKind::series, ObservableKind::profile,
                                      ObservableKind::surface, ObservableKind::scalar};
  o.kind = kinds[entry.at("kind").choice({"trajectory", "series", "profile", "surface", "scalar"})];
  switch (o.kind) {
    case ObservableKind::trajectory:
      entry.only({"kind", "body"});
      o.name = "position";
      o.body = read_body(entry.at("body"), scene);
      break;
    case ObservableKind::series:
      entry.only({"kind", "name", "body", "axis", "unit"});
      o.name = read_name(entry.at("name"), {"specific_force", "speed", "height", "discharged_mass", "mass_on_base",
                                            "roller_force_x", "roller_force_z", "roller_torque", "surface_angle"});
      if (o.name == "surface_angle") o.unit = "deg";
      if (o.name == "specific_force" || o.name == "speed" || o.name == "height")
        o.body = read_body(entry.at("body"), scene);
      if (o.name == "specific_force") {
        o.axis = entry.at("axis").vector(any(dimension::none));
        if (!(o.axis->norm() > 0))
          entry.at("axis").fail("an axis without direction", "give a vector such as [0, 0, 1]");
        o.axis->normalize();
      }
      break;
    case ObservableKind::profile:
      entry.only({"kind", "name", "unit"});
      o.name = read_name(entry.at("name"), {"heap"});
      break;
    case ObservableKind::surface:
      entry.only({"kind", "name"});
      o.name = read_name(entry.at("name"), {"layer_before", "layer_after"});
      break;
    default:
      entry.only({"kind", "name", "unit"});
      o.name = read_name(entry.at("name"), {"angle_of_repose"});
      o.unit = "deg";
  }
  if (entry.has("unit")) read_unit(entry, o);
  if (scene.layer && !told_of_a_layer(o))
    entry.fail(fmt::format("`{}` is not recorded of a scene with a `layer` block", o.name),
               "those that are: surfaces layer_before and layer_after, series roller_force_x, roller_force_z, roller_torque");
  if (!scene.layer && o.kind == ObservableKind::surface)
    entry.fail("a surface is recorded of a layer alone", "add a `layer` block; see scenarios/configs/layer-quick.yaml");
  return o;
}

std::vector<std::string> texts(const YamlReader& reader) {
  std::vector<std::string> result;
  for (const YamlReader& item : reader.items()) result.push_back(item.text());
  return result;
}

std::vector<Override> read_changes(const YamlReader& block) {
  std::vector<Override> changes;
  if (block.node().kind != YamlNode::Kind::map) block.fail("expected a map of scene keys", "write `{key.path: value}`");
  for (const YamlEntry& entry : block.node().entries) changes.push_back({entry.key, emit_yaml(entry.value)});
  return changes;
}

void read_runs(const YamlReader& block, RecordBlock& record) {
  std::set<std::string> ids;
  for (const YamlReader& item : block.items()) {
    item.only({"id", "set"});
    RecordedRun run{item.at("id").text(), {}};
    if (run.id.empty() || run.id.find('/') != std::string::npos)
      item.at("id").fail("not a name for a file", "use letters, digits, `-`");
    if (!ids.insert(run.id).second)
      item.at("id").fail(fmt::format("run `{}` is there twice", run.id), "give each run an id of its own");
    if (item.has("set")) run.set = read_changes(item.at("set"));
    record.runs.push_back(std::move(run));
  }
}

void read_sensor(const YamlReader& block, RecordBlock& record) {
  block.read("rate", record.sensor.rate, positive(dimension::frequency));
  block.read("dropouts", record.sensor.dropouts,
             {.dimension = dimension::none, .lower = 0, .upper = 1, .upper_open = true});
  if (!block.has("noise")) return;
  std::set<std::string> names;
  for (const Observation& o : record.observables) {
    names.insert(o.name);
    if (o.kind == ObservableKind::trajectory) names.insert("orientation");
  }
  block.at("noise").only({names.begin(), names.end()});
  for (const auto& [name, reader] : block.at("noise").named())
    record.sensor.noise[name] = reader.number(non_negative(name == "position"      ? dimension::length
                                                           : name == "orientation" ? dimension::angle
                                                                                   : dimension::none));
}

}  // namespace

bool told_of_a_layer(const Observation& o) {
  if (o.kind == ObservableKind::surface) return o.name == "layer_before" || o.name == "layer_after";
  return o.kind == ObservableKind::series && o.body.empty() && (o.name == "roller_force_x" || o.name == "roller_force_z" || o.name == "roller_torque");
}

RecordBlock read_record_block(const Scene& scene, const std::string& name) {
  RecordBlock record;
  YamlNode tree = parse_yaml(scene.text, name);
  const YamlReader root(tree, name);
  if (root.has("record")) {
    const YamlReader block = root.at("record");
    if (block.has("observables"))
      for (const YamlReader& entry : block.at("observables").items())
        record.observables.push_back(read_observable(entry, scene));
    read_sensor(block, record);
    if (block.has("runs")) read_runs(block.at("runs"), record);
    if (block.has("conceal")) record.conceal = read_changes(block.at("conceal"));
    if (block.has("free")) record.free = texts(block.at("free"));
    if (block.has("calibrate")) record.calibrate = texts(block.at("calibrate"));
  }
  if (record.observables.empty())
    for (const SceneBody& body : scene.bodies)
      if (!body.fixed && !body.motion) {
        record.observables.emplace_back();
        record.observables.back().name = "position";
        record.observables.back().body = body.name;
      }
  if (record.observables.empty())
    root.fail("nothing to record: no body moves freely", "add `record: {observables: [...]}`");
  if (record.runs.empty()) record.runs.push_back({"run-01", {}});
  std::erase_if(tree.entries, [](const YamlEntry& entry) { return entry.key == "record"; });
  record.scene_without_record = emit_yaml(tree);
  return record;
}

std::vector<double> sample_times(double rate, double duration) {
  std::vector<double> times;
  for (std::size_t i = 0; static_cast<double>(i) <= duration * rate * (1 + 1e-12); ++i)
    times.push_back(static_cast<double>(i) / rate);
  return times;
}

std::string file_name(const std::string& run, const Observation& o, const std::vector<Observation>& all) {
  if (all.size() == 1) return run + ".csv";
  // Several axes of one sensor are told apart by their number.
  std::size_t same = 0, place = 0;
  for (const Observation& other : all) {
    if (other.body != o.body || other.name != o.name) continue;
    ++same;
    if (other.axis == o.axis) place = same;
  }
  return fmt::format("{}-{}{}{}.csv", run, o.body.empty() ? "" : o.body + "-", o.name, same > 1 ? fmt::format("-{}", place) : "");
}

}  // namespace repose
