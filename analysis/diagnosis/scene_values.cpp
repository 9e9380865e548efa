#include "analysis/diagnosis/scene_values.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace repose::diagnosis {

void put_values(YamlNode& tree, const std::vector<Parameter>& parameters, const Eigen::VectorXd& values,
                const std::vector<Quat>& start_orientation) {
  std::size_t turned = 0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& p = parameters[i];
    const auto k = static_cast<Eigen::Index>(i);
    if (p.use == Parameter::Use::scene) {
      // The shortest text that reads back to the same bits.
      const std::string text = fmt::format("{}", values[k]), path = p.component < 0 ? p.key : fmt::format("{}.{}", p.key, p.component);
      const YamlNode* present = p.component < 0 ? nullptr : node_at(tree, p.key);
      if (p.component >= 0 && (present == nullptr || present->kind != YamlNode::Kind::sequence))
        set_path(tree, p.key, "[0, 0, 0]");  // not written out in the scene
      set_path(tree, path, text);
    } else if (p.use == Parameter::Use::turn && p.component == 0) {
      const Quat q = (rotation_of(values.segment<3>(k)) * start_orientation.at(turned++)).normalized();
      set_path(tree, p.key, fmt::format("[{}, {}, {}, {}]", q.w(), q.x(), q.y(), q.z()));
    }
  }
}

}  // namespace repose::diagnosis
