#pragma once
/// A Model inside an HDF5 file: exactly what was written comes back.
///
/// Under `group`: one dataset per field of a body and of the initial state (names as in model.hpp), and `description`, a
/// JSON text with the rest: materials, laws, shapes, names, gravity, the periodic cell if there is one, effects, and the motions and times of the bodies that
/// have any. Numbers keep every bit; an infinite one is written "inf" or "-inf" in the JSON.
#include <cstdint>
#include <string>

#include "core/hdf5_file.hpp"
#include "core/model.hpp"

namespace repose {

void write_model(Hdf5Writer& file, const std::string& group, const Model& model);
Model read_model(const Hdf5Reader& file, const std::string& group);

/// A number that tells two models apart: the checksum of everything that write_model writes.
std::uint64_t fingerprint(const Model& model);

/// The JSON text, and back (bodies are made here as far as the text speaks of them; `body_count` in all).
std::string describe_model(const Model& model);
void parse_model_description(const std::string& json, std::size_t body_count, Model& model);

}  // namespace repose
