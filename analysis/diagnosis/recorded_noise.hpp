#pragma once
/// The noise of a bundle's observables.
#include <map>
#include <string>
#include <vector>

#include "analysis/bundle/bundle.hpp"
#include "analysis/diagnosis/observation_model.hpp"

namespace repose::diagnosis {

/// By observable: as the bundle gives it (readings in steps of q that scatter by more have sqrt(sd^2 + q^2 / 12), as far as they do), else noise_model() of all
/// runs and axes together. At least 1e-4 of the observable's range (of what the bundle gives: 1e-6), for
/// less is a number that nothing disturbed, and no model is exact to that.
std::map<std::string, NoiseModel> recorded_noise(const Bundle& bundle, const std::vector<std::size_t>& runs);

/// The same as if the bundle gave none.
std::map<std::string, NoiseModel> scatter_of_samples(const Bundle& bundle, const std::vector<std::size_t>& runs);

}  // namespace repose::diagnosis
