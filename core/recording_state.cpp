#include "core/recording_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>

namespace repose {

template <class T>
std::vector<T> flattened(const std::vector<Vec3>& vectors) {
  std::vector<T> out;
  out.reserve(3 * vectors.size());
  for (const Vec3& v : vectors)
    for (int k = 0; k < 3; ++k) out.push_back(static_cast<T>(v[k]));
  return out;
}

template <class T>
std::vector<T> flattened(const std::vector<Quat>& rotations) {
  std::vector<T> out;
  out.reserve(4 * rotations.size());
  for (const Quat& q : rotations)
    for (const double c : {q.w(), q.x(), q.y(), q.z()}) out.push_back(static_cast<T>(c));
  return out;
}

template <class T>
std::vector<Vec3> vectors_from(const std::vector<T>& values) {
  std::vector<Vec3> out(values.size() / 3);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = Vec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
  return out;
}

namespace {

template <class T>
std::vector<Quat> rotations_from(const std::vector<T>& values) {
  std::vector<Quat> out(values.size() / 4);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = Quat(values[4 * i], values[4 * i + 1], values[4 * i + 2], values[4 * i + 3]);
    // Rounding to float32 leaves unit length only to 1e-7; a double one must keep its bits.
    if constexpr (!std::is_same_v<T, double>) out[i].normalize();
  }
  return out;
}

/// The columns of the step log. Writing and reading both follow this list.
template <class Visit>
void for_each_column(Visit&& visit) {
  visit("time", double{}, [](auto& r) -> auto& { return r.time; });
  visit("contacts", std::int32_t{}, [](auto& r) -> auto& { return r.report.contacts; });
  visit("iterations", std::int32_t{}, [](auto& r) -> auto& { return r.report.iterations; });
  visit("residual", double{}, [](auto& r) -> auto& { return r.report.residual; });
  visit("converged", std::uint8_t{}, [](auto& r) -> auto& { return r.report.converged; });
  visit("cycling", std::uint8_t{}, [](auto& r) -> auto& { return r.report.cycling; });
  visit("penetration", double{}, [](auto& r) -> auto& { return r.report.penetration; });
  visit("contact_work", double{}, [](auto& r) -> auto& { return r.report.contact_work; });
}

/// What is told of the tracked tool, likewise.
template <class Visit>
void for_each_vector_of_tool(Visit&& visit) {
  visit("tool_force", &StepRecord::tool_force);
  visit("tool_torque", &StepRecord::tool_torque);
}
constexpr const char* rise_column = "/tool_rise";

}  // namespace

template <class T>
void write_snapshot(Hdf5Writer& file, const std::string& group, const Snapshot& state) {
  file.write(group + "/time", std::vector<double>{state.time});
  file.write(group + "/position", flattened<T>(state.position), 3);
  file.write(group + "/orientation", flattened<T>(state.orientation), 4);
  file.write(group + "/velocity", flattened<T>(state.velocity), 3);
  file.write(group + "/angular_velocity", flattened<T>(state.angular_velocity), 3);
}

template <class T>
Snapshot read_snapshot(const Hdf5Reader& file, const std::string& group, std::size_t bodies) {
  Snapshot state;
  state.time = file.read<double>(group + "/time", 1, 1).front();
  state.position = vectors_from(file.read<T>(group + "/position", 3, bodies));
  state.orientation = rotations_from(file.read<T>(group + "/orientation", 4, bodies));
  state.velocity = vectors_from(file.read<T>(group + "/velocity", 3, bodies));
  state.angular_velocity = vectors_from(file.read<T>(group + "/angular_velocity", 3, bodies));
  return state;
}

template std::vector<double> flattened(const std::vector<Vec3>&);
template std::vector<Vec3> vectors_from(const std::vector<double>&);
template void write_snapshot<float>(Hdf5Writer&, const std::string&, const Snapshot&);
template void write_snapshot<double>(Hdf5Writer&, const std::string&, const Snapshot&);
template Snapshot read_snapshot<float>(const Hdf5Reader&, const std::string&, std::size_t);
template Snapshot read_snapshot<double>(const Hdf5Reader&, const std::string&, std::size_t);

void write_steps(Hdf5Writer& file, const std::string& group, const std::vector<StepRecord>& steps) {
  for_each_column([&](const char* name, auto type, auto field) {
    std::vector<decltype(type)> column;
    column.reserve(steps.size());
    for (const StepRecord& record : steps) column.push_back(static_cast<decltype(type)>(field(record)));
    file.write(group + "/" + name, column);
  });
  for_each_vector_of_tool([&](const char* name, auto field) {
    std::vector<Vec3> column;
    for (const StepRecord& record : steps) column.push_back(record.*field);
    // Most runs track no tool.
    if (std::any_of(column.begin(), column.end(), [](const Vec3& v) { return v != Vec3::Zero(); }))
      file.write(group + "/" + name, flattened<double>(column), 3);
  });
  std::vector<double> rise;
  for (const StepRecord& record : steps) rise.push_back(record.tool_rise);
  if (std::any_of(rise.begin(), rise.end(), [](double x) { return x != 0; })) file.write(group + rise_column, rise);
}

std::vector<StepRecord> read_steps(const Hdf5Reader& file, const std::string& group) {
  std::vector<StepRecord> steps(file.read<double>(group + "/time").size());
  for_each_column([&](const char* name, auto type, auto field) {
    const auto column = file.read<decltype(type)>(group + "/" + name, 1, steps.size());
    for (std::size_t i = 0; i < steps.size(); ++i) {
      auto& target = field(steps[i]);
      target = static_cast<std::remove_reference_t<decltype(target)>>(column[i]);
    }
  });
  for_each_vector_of_tool([&](const char* name, auto field) {
    if (!file.has(group + "/" + name)) return;
    const std::vector<Vec3> column = vectors_from(file.read<double>(group + "/" + name, 3, steps.size()));
    for (std::size_t i = 0; i < steps.size(); ++i) steps[i].*field = column[i];
  });
  if (file.has(group + rise_column)) {
    const auto rise = file.read<double>(group + rise_column, 1, steps.size());
    for (std::size_t i = 0; i < steps.size(); ++i) steps[i].tool_rise = rise[i];
  }
  return steps;
}

std::string frame_file_name(std::size_t index) { return fmt::format("frame-{:06d}.h5", index); }

}  // namespace repose
