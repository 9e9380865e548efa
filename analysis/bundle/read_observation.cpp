#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <set>

#include "analysis/bundle/bundle_units.hpp"
#include "analysis/bundle/csv_table.hpp"
#include "analysis/bundle/read_bundle.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double quaternion_slack = 0.01;  // tracking software rounds; more is a wrong column order or a raw matrix

void demand_columns(const CsvTable& table, const std::vector<std::string>& needed,
                    const std::vector<std::string>& allowed) {
  for (const std::string& name : table.column) {
    if (std::find(allowed.begin(), allowed.end(), name) != allowed.end()) continue;
    const Suggestion suggestion = suggest("unknown column", name, allowed);
    throw Error(table.name, suggestion.problem, suggestion.remedy);
  }
  for (const std::string& name : needed)
    if (table.find(name) < 0)
      throw Error(table.name, fmt::format("column `{}` is missing", name),
                  fmt::format("columns of such a file: {}", fmt::join(allowed, ",")));
}

/// Appends the time of a row; it must exist and ascend.
void take_time(const CsvTable& table, const CsvRow& row, std::vector<double>& times) {
  const int column = table.find("time");
  const double t = table.number(row, column);
  if (std::isnan(t)) throw Error(table.place(row, column), "a sample has no time", "give it, or remove the line");
  if (!times.empty() && !(t > times.back()))
    throw Error(table.place(row, column), fmt::format("time {} s comes after {} s", t, times.back()),
                "times must ascend: sort the lines, and remove doubled samples");
  times.push_back(t);
}

Quat take_orientation(const CsvTable& table, const CsvRow& row) {
  double q[4];
  int given = 0;
  const char* names[] = {"qw", "qx", "qy", "qz"};
  for (int i = 0; i < 4; ++i) {
    q[i] = table.number(row, table.find(names[i]));
    given += std::isnan(q[i]) ? 0 : 1;
  }
  if (given == 0) return Quat(nan, nan, nan, nan);
  const std::string place = fmt::format("{}:{}: qw,qx,qy,qz", table.name, row.line);
  if (given < 4) throw Error(place, "a quaternion lacks components", "give all four, or none");
  const Quat result(q[0], q[1], q[2], q[3]);
  if (std::abs(result.norm() - 1) > quaternion_slack)
    throw Error(
        place, fmt::format("a quaternion of length {:.4g}", result.norm()),
        "orientations are unit quaternions, scalar first, body to world: normalise them, or mend the columns' order");
  return result.normalized();
}

void read_trajectory(const CsvTable& table, Observation& o) {
  demand_columns(table, {"time"}, {"time", "body", "x", "y", "z", "qw", "qx", "qy", "qz"});
  const int columns[] = {table.find("x"), table.find("y"), table.find("z")}, body = table.find("body");
  const int turning =
      (table.find("qw") >= 0) + (table.find("qx") >= 0) + (table.find("qy") >= 0) + (table.find("qz") >= 0);
  if (turning != 0 && turning != 4)
    throw Error(table.name, "an orientation lacks columns", "give qw,qx,qy,qz, or none of them");
  bool turns = false, seen = false;
  std::string other;
  for (const CsvRow& row : table.rows) {
    if (body >= 0) {
      const std::string& name = row.field[static_cast<std::size_t>(body)];
      if (name.empty()) throw Error(table.place(row, body), "a sample has no body", "name it, or remove the column");
      if (name != o.body) {
        other = name;
        continue;
      }
    }
    take_time(table, row, o.time);
    Vec3 x;
    for (int i = 0; i < 3; ++i) x[i] = columns[i] < 0 ? nan : table.number(row, columns[i]);
    o.position.push_back(x);
    o.orientation.push_back(turning == 4 ? take_orientation(table, row) : Quat(nan, nan, nan, nan));
    turns = turns || std::isfinite(o.orientation.back().w());
    seen = seen || turns || !x.array().isNaN().all();
  }
  if (!other.empty() && o.time.empty())
    throw Error(table.name, fmt::format("no sample of body `{}`, but of `{}`", o.body, other),
                "name in recording.yaml the body that the file holds");
  if (!turns) o.orientation.clear();
  if (o.time.size() < 2)
    throw Error(table.name,
                fmt::format("{} sample{} of body `{}`", o.time.size(), o.time.size() == 1 ? "" : "s", o.body),
                "a trajectory needs two samples at least");
  if (!seen) throw Error(table.name, "no axis was observed: all fields are empty", "leave the observable out");
}

void read_series(const CsvTable& table, Observation& o) {
  demand_columns(table, {"time", "value"}, {"time", "value"});
  std::size_t seen = 0;
  for (const CsvRow& row : table.rows) {
    take_time(table, row, o.time);
    o.value.push_back(table.number(row, table.find("value")));
    seen += std::isnan(o.value.back()) ? 0 : 1;
  }
  if (seen < 2)
    throw Error(table.name, fmt::format("{} sample{}", seen, seen == 1 ? "" : "s"),
                "a series needs two samples at least");
}

void read_profile(const CsvTable& table, Observation& o) {
  const bool radial = table.find("radius") >= 0;
  const std::string at = radial ? "radius" : "x";
  demand_columns(table, {at, "height"}, {"time", at, "height"});
  for (const CsvRow& row : table.rows) {
    const double x = table.number(row, table.find(at));
    if (std::isnan(x))
      throw Error(table.place(row, table.find(at)), "a sample has no place", "give it, or remove the line");
    o.at.push_back(x);
    o.value.push_back(table.number(row, table.find("height")));
    if (table.find("time") >= 0) {
      o.time.push_back(table.number(row, table.find("time")));
      if (std::isnan(o.time.back()))
        throw Error(table.place(row, table.find("time")), "a sample has no time", "give it, or remove the column");
      if (o.time.size() > 1 && o.time.back() < o.time[o.time.size() - 2])
        throw Error(table.place(row, table.find("time")), "the profiles are not in the order of their times", "sort the lines by time: the last profile is taken for the final one");
    }
  }
  if (o.at.size() < 2)
    throw Error(table.name, "a profile of fewer than two points", "give the heights of two places at least");
}

void read_surface(const CsvTable& table, Observation& o) {
  demand_columns(table, {"x", "y", "height"}, {"x", "y", "height"});
  for (const CsvRow& row : table.rows) {
    for (const char* name : {"x", "y"})
      if (std::isnan(table.number(row, table.find(name))))
        throw Error(table.place(row, table.find(name)), "a sample has no place", "give it, or remove the line");
    o.at.push_back(table.number(row, table.find("x")));
    o.at_y.push_back(table.number(row, table.find("y")));
    o.value.push_back(table.number(row, table.find("height")));
  }
  if (o.at.size() < 4)
    throw Error(table.name, "a surface of fewer than four points", "give a grid of two by two at least");
  const std::set<double> xs(o.at.begin(), o.at.end()), ys(o.at_y.begin(), o.at_y.end());
  if (xs.size() * ys.size() != o.at.size())
    throw Error(table.name, fmt::format("{} points do not make a grid of {} x by {} y", o.at.size(), xs.size(), ys.size()),
                "give every x with every y once; where nothing was seen, leave the height empty");
}

std::string read_body(const YamlReader& entry, const Scene& scene) {
  const YamlReader reader = entry.at("body");
  const std::string name = reader.text();
  std::vector<std::string> names;
  for (const SceneBody& body : scene.bodies) {
    const bool moves = !body.fixed && !body.motion;
    if (moves) names.push_back(body.name);
    if (!moves && body.name == name)
      reader.fail(fmt::format("body `{}` is fixed or driven in the scene: its path tells nothing", name), "name a body that moves freely");
  }
  if (std::find(names.begin(), names.end(), name) != names.end()) return name;
  const Suggestion suggestion = suggest("the scene has no body", name, names);
  reader.fail(suggestion.problem, suggestion.remedy);
}

}  // namespace

const std::string& kind_name(ObservableKind kind) {
  static const std::string names[] = {"trajectory", "series", "profile", "surface", "scalar"};
  return names[static_cast<std::size_t>(kind)];
}

const std::vector<std::string>& reserved_series() {
  static const std::vector<std::string> names{"discharged_mass", "mass_on_base",  "roller_force_x",
                                              "roller_force_z",  "roller_torque", "surface_angle",
                                              "specific_force",  "speed",         "height"};
  return names;
}

void cut(Observation& o, double from, double until) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < o.time.size(); ++i) {
    if (o.time[i] < from || o.time[i] > until) continue;
    o.time[kept] = o.time[i] - from;
    if (!o.position.empty()) o.position[kept] = o.position[i];
    if (!o.orientation.empty()) o.orientation[kept] = o.orientation[i];
    if (!o.value.empty()) o.value[kept] = o.value[i];
    ++kept;
  }
  o.time.resize(kept);
  o.position.resize(std::min(kept, o.position.size()));
  o.orientation.resize(std::min(kept, o.orientation.size()));
  o.value.resize(std::min(kept, o.value.size()));
}

Observation read_observation(const YamlReader& entry, const BundleFiles& files, const Scene& scene) {
  Observation o;
  o.kind =
      static_cast<ObservableKind>(entry.at("kind").choice({"trajectory", "series", "profile", "surface", "scalar"}));
  switch (o.kind) {
    case ObservableKind::trajectory:
      entry.only({"kind", "body", "file"});
      break;
    case ObservableKind::series:
      entry.only({"kind", "name", "body", "axis", "unit", "file"});
      break;
    case ObservableKind::profile:
    case ObservableKind::surface:
      entry.only({"kind", "name", "unit", "file"});
      break;
    case ObservableKind::scalar:
      entry.only({"kind", "name", "value", "sd", "unit"});
      break;
  }
  o.name = o.kind == ObservableKind::trajectory ? "position" : entry.at("name").text();
  if (entry.has("unit")) o.unit = entry.at("unit").text();
  const bool of_a_body =
      o.kind == ObservableKind::trajectory || o.name == "specific_force" || o.name == "speed" || o.name == "height";
  if (of_a_body || entry.has("body")) o.body = read_body(entry, scene);
  if (o.name == "specific_force") {
    Vec3 axis = entry.at("axis").vector(any(dimension::none));
    if (!(axis.norm() > 0)) entry.at("axis").fail("an axis without direction", "give a vector such as [0, 0, 1]");
    o.axis = axis.normalized();
  } else if (entry.has("axis")) {
    entry.at("axis").fail("only `specific_force` has an axis", "remove it");
  }
  if (o.kind == ObservableKind::scalar) {
    o.scalar = entry.at("value").number(any(dimension::none));
    if (entry.has("sd")) o.sd = entry.at("sd").number(positive(dimension::none));
    turn_into_si(entry, o);
    return o;
  }
  o.file = entry.at("file").text();
  const CsvTable table = files.table(o.file);
  switch (o.kind) {
    case ObservableKind::trajectory:
      read_trajectory(table, o);
      break;
    case ObservableKind::series:
      read_series(table, o);
      turn_into_si(entry, o);
      break;
    case ObservableKind::profile:
      read_profile(table, o);
      turn_into_si(entry, o);
      break;
    case ObservableKind::surface:
      read_surface(table, o);
      turn_into_si(entry, o);
      break;
    case ObservableKind::scalar:
      break;
  }
  return o;
}

}  // namespace repose
