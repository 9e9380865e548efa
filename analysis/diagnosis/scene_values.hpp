#pragma once
/// Values of parameters, written into a scene.
#include <vector>

#include <Eigen/Core>

#include "analysis/diagnosis/hypothesis.hpp"
#include "core/math.hpp"

namespace repose::diagnosis {

/// Sets the scene keys of the parameters. `start_orientation`: of each turn parameter in their order; its rotation vector [rad] is
/// applied to that. Parameters of the measurement are left out.
void put_values(YamlNode& tree, const std::vector<Parameter>& parameters, const Eigen::VectorXd& values,
                const std::vector<Quat>& start_orientation = {});

}  // namespace repose::diagnosis
