#include "core/recording_xdmf.hpp"

#include <fmt/format.h>

#include "core/recording_state.hpp"

namespace repose {
namespace {

struct Array {
  const char* name;
  const char* kind;  ///< XDMF AttributeType
  std::size_t columns;
  const char* number;
  int precision;  ///< bytes per number
  std::string place;
};

std::string data_item(const Array& array, std::size_t rows) {
  const std::string extent = array.columns == 1 ? fmt::format("{}", rows) : fmt::format("{} {}", rows, array.columns);
  return fmt::format("<DataItem Dimensions=\"{}\" NumberType=\"{}\" Precision=\"{}\" Format=\"HDF\">{}</DataItem>", extent,
                     array.number, array.precision, array.place);
}

std::string frame_grid(std::size_t bodies, std::size_t index, double time) {
  const std::string frame = "frames/" + frame_file_name(index) + ":/";
  const Array position{"position", "Vector", 3, "Float", 4, frame + "position"};
  // VTK takes a Vector with as many components as there are columns, but a Matrix as one tuple.
  const Array attributes[] = {
      {"radius", "Scalar", 1, "Float", 4, "run.h5:/display/radius"},
      {"shape", "Scalar", 1, "Int", 4, "run.h5:/model/bodies/shape"},
      {"material", "Scalar", 1, "Int", 4, "run.h5:/model/bodies/material"},
      {"role", "Scalar", 1, "UChar", 1, "run.h5:/model/bodies/role"},
      {"velocity", "Vector", 3, "Float", 4, frame + "velocity"},
      {"angular_velocity", "Vector", 3, "Float", 4, frame + "angular_velocity"},
      {"orientation", "Vector", 4, "Float", 4, frame + "orientation"},
  };
  std::string text = fmt::format(
      "      <Grid Name=\"frame {0}\" GridType=\"Uniform\">\n"
      "        <Time Value=\"{1:.17g}\"/>\n"
      "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{2}\"/>\n"
      "        <Geometry GeometryType=\"XYZ\">{3}</Geometry>\n",
      index, time, bodies, data_item(position, bodies));
  for (const Array& array : attributes)
    text += fmt::format("        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">{}</Attribute>\n", array.name,
                        array.kind, data_item(array, bodies));
  return text + "      </Grid>\n";
}

}  // namespace

std::string xdmf_text(std::size_t bodies, const std::vector<double>& frame_times, const PeriodicCell& periodic) {
  std::string text =
      "<?xml version=\"1.0\" ?>\n"
      "<Xdmf Version=\"2.0\">\n"
      "  <Domain>\n";
  for (int axis = 0; axis < 3; ++axis)
    if (periodic.along(axis))
      text += fmt::format("    <Information Name=\"periodic_{}\" Value=\"{:.17g} {:.17g}\"/>\n", "xyz"[axis],
                          periodic.lower[axis], periodic.upper[axis]);
  text +=
      "    <Grid Name=\"run\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (std::size_t i = 0; i < frame_times.size(); ++i) text += frame_grid(bodies, i, frame_times[i]);
  return text + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

}  // namespace repose
