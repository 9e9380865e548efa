#include "core/recording_model.hpp"

#include <exception>
#include <type_traits>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/recording_state.hpp"

namespace repose {
namespace {

/// The columns of the table of bodies: name, type in the file, access. Both directions follow this list.
template <class Visit>
void for_each_column(Visit&& visit) {
  visit("shape", std::int32_t{}, [](auto& b) -> auto& { return b.shape; });
  visit("material", std::int32_t{}, [](auto& b) -> auto& { return b.material; });
  visit("name", std::int32_t{}, [](auto& b) -> auto& { return b.name; });
  visit("role", std::uint8_t{}, [](auto& b) -> auto& { return b.role; });
  visit("dynamic", std::uint8_t{}, [](auto& b) -> auto& { return b.dynamic; });
  visit("scale", double{}, [](auto& b) -> auto& { return b.scale; });
  visit("mass", double{}, [](auto& b) -> auto& { return b.mass; });
  visit("radius", double{}, [](auto& b) -> auto& { return b.radius; });
  visit("volume", double{}, [](auto& b) -> auto& { return b.volume; });
  visit("gate_tolerance", double{}, [](auto& b) -> auto& { return b.gate_tolerance; });
}

std::vector<Vec3> inertias(const Model& model) {
  std::vector<Vec3> out;
  out.reserve(model.bodies.size());
  for (const Body& body : model.bodies) out.push_back(body.inertia);
  return out;
}

}  // namespace

void write_model(Hdf5Writer& file, const std::string& group, const Model& model) {
  const std::string text = describe_model(model);
  file.write(group + "/description", std::vector<std::uint8_t>(text.begin(), text.end()));
  for_each_column([&](const char* name, auto type, auto field) {
    std::vector<decltype(type)> column;
    column.reserve(model.bodies.size());
    for (const Body& body : model.bodies) column.push_back(static_cast<decltype(type)>(field(body)));
    file.write(group + "/bodies/" + name, column);
  });
  file.write(group + "/bodies/inertia", flattened<double>(inertias(model)), 3);
  write_snapshot<double>(file, group + "/initial", model.initial);
}

Model read_model(const Hdf5Reader& file, const std::string& group) {
  const std::size_t count = file.read<std::int32_t>(group + "/bodies/shape").size();
  const std::vector<std::uint8_t> text = file.read<std::uint8_t>(group + "/description");
  Model model;
  try {
    parse_model_description(std::string(text.begin(), text.end()), count, model);
  } catch (const std::exception& problem) {
    throw Error(group + "/description", std::string("is not a description of a model: ") + problem.what(),
                "the file was written by another version or is damaged; run the scene again");
  }
  for_each_column([&](const char* name, auto type, auto field) {
    const auto column = file.read<decltype(type)>(group + "/bodies/" + name, 1, count);
    for (std::size_t i = 0; i < count; ++i) {
      auto& target = field(model.bodies[i]);
      target = static_cast<std::remove_reference_t<decltype(target)>>(column[i]);
    }
  });
  const std::vector<Vec3> inertia = vectors_from(file.read<double>(group + "/bodies/inertia", 3, count));
  for (std::size_t i = 0; i < count; ++i) model.bodies[i].inertia = inertia[i];
  model.initial = read_snapshot<double>(file, group + "/initial", count);
  return model;
}

std::uint64_t fingerprint(const Model& model) {
  Hdf5Writer file(Hdf5Writer::Packing::plain);
  write_model(file, "/model", model);
  return checksum(file.bytes());
}

}  // namespace repose
