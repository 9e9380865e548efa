#include "analysis/bundle/write_bundle.hpp"

#include <fmt/format.h>

#include <cmath>

#include "analysis/bundle/csv_table.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/yaml_tree.hpp"

namespace repose {
namespace {

std::string number(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

std::string csv_of(const Observation& o) {
  std::string text;
  switch (o.kind) {
    case ObservableKind::trajectory:
      text = o.orientation.empty() ? "time,body,x,y,z\n" : "time,body,x,y,z,qw,qx,qy,qz\n";
      for (std::size_t i = 0; i < o.time.size(); ++i) {
        const Vec3& x = o.position[i];
        text += fmt::format("{},{},{},{},{}", number(o.time[i]), csv_field(o.body), number(x.x()), number(x.y()),
                            number(x.z()));
        if (!o.orientation.empty()) {
          const Quat& q = o.orientation[i];
          text += fmt::format(",{},{},{},{}", number(q.w()), number(q.x()), number(q.y()), number(q.z()));
        }
        text += '\n';
      }
      break;
    case ObservableKind::series:
      text = "time,value\n";
      for (std::size_t i = 0; i < o.time.size(); ++i) text += number(o.time[i]) + ',' + number(o.value[i]) + '\n';
      break;
    case ObservableKind::profile:
      text = o.time.empty() ? "radius,height\n" : "time,radius,height\n";
      for (std::size_t i = 0; i < o.at.size(); ++i)
        text += (o.time.empty() ? "" : number(o.time[i]) + ',') + number(o.at[i]) + ',' + number(o.value[i]) + '\n';
      break;
    case ObservableKind::surface:
      text = "x,y,height\n";
      for (std::size_t i = 0; i < o.at.size(); ++i)
        text += number(o.at[i]) + ',' + number(o.at_y[i]) + ',' + number(o.value[i]) + '\n';
      break;
    case ObservableKind::scalar:
      break;
  }
  return text;
}

YamlNode scalar(const std::string& text) {
  YamlNode node;
  node.kind = YamlNode::Kind::scalar;
  node.text = text;
  return node;
}
YamlNode map() {
  YamlNode node;
  node.kind = YamlNode::Kind::map;
  return node;
}
YamlNode list(const std::vector<std::string>& texts) {
  YamlNode node;
  node.kind = YamlNode::Kind::sequence;
  for (const std::string& text : texts) node.items.push_back(scalar(text));
  return node;
}
void put(YamlNode& node, const std::string& key, YamlNode value) { node.entries.push_back({key, 0, std::move(value)}); }
void put(YamlNode& node, const std::string& key, const std::string& value) {
  if (!value.empty()) put(node, key, scalar(value));
}

YamlNode described(const Observation& o) {
  YamlNode node = map();
  put(node, "kind", kind_name(o.kind));
  if (o.kind != ObservableKind::trajectory) put(node, "name", o.name);
  put(node, "body", o.body);
  if (o.axis) put(node, "axis", list({number(o.axis->x()), number(o.axis->y()), number(o.axis->z())}));
  if (o.kind == ObservableKind::scalar) {
    put(node, "value", number(o.scalar));
    if (o.sd > 0) put(node, "sd", number(o.sd));
  }
  if (o.kind != ObservableKind::trajectory) put(node, "unit", o.unit);
  put(node, "file", o.file);
  return node;
}

YamlNode described(const BundleRun& run, bool split_given) {
  YamlNode node = map();
  put(node, "id", run.id);
  if (!run.set.empty()) {
    YamlNode set = map();
    for (const Override& change : run.set) put(set, change.path, parse_yaml(change.value, change.path));
    put(node, "set", std::move(set));
  }
  if (!run.free.empty()) put(node, "free", list(run.free));
  if (split_given) put(node, "held_out", run.held_out ? "true" : "false");
  YamlNode observables;
  observables.kind = YamlNode::Kind::sequence;
  for (const Observation& o : run.observations) observables.items.push_back(described(o));
  put(node, "observables", std::move(observables));
  return node;
}

}  // namespace

void write_bundle(const std::filesystem::path& folder, const Bundle& bundle) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure)
    throw Error("--out " + folder.string(), "cannot be created: " + failure.message(), "choose another folder");
  std::filesystem::remove(folder / "recording.yaml", failure);
  for (const BundleRun& run : bundle.runs)
    for (const Observation& o : run.observations)
      if (!o.file.empty()) write_durably(folder / o.file, csv_of(o));
  write_durably(folder / "nominal.yaml", bundle.scene.text);

  YamlNode root = map();
  put(root, "title", bundle.title);
  put(root, "source", bundle.source);
  put(root, "licence", bundle.licence);
  put(root, "scene", std::string("nominal.yaml"));
  if (!bundle.calibrate.empty()) put(root, "calibrate", list(bundle.calibrate));
  if (!bundle.noise.empty()) {
    YamlNode noise = map();
    for (const auto& [name, sd] : bundle.noise) put(noise, name, number(sd));
    put(root, "noise", std::move(noise));
  }
  YamlNode runs;
  runs.kind = YamlNode::Kind::sequence;
  for (const BundleRun& run : bundle.runs) runs.items.push_back(described(run, bundle.split_given));
  put(root, "runs", std::move(runs));
  write_durably(folder / "recording.yaml", emit_yaml(root));
}

}  // namespace repose
