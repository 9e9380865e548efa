#pragma once
/// States, step logs and frames as HDF5 datasets: the pieces that run.h5, frames and checkpoints share.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/hdf5_file.hpp"
#include "core/model.hpp"
#include "core/recording.hpp"

namespace repose {

/// Rows of three, and of four (scalar first), one after another.
template <class T>
std::vector<T> flattened(const std::vector<Vec3>& vectors);
template <class T>
std::vector<T> flattened(const std::vector<Quat>& rotations);
template <class T>
std::vector<Vec3> vectors_from(const std::vector<T>& values);

/// Snapshots as datasets of T: time (double), position, orientation (scalar first), velocity, angular_velocity.
/// `group` is "" or begins with '/'. `bodies`: how many there must be.
template <class T>
void write_snapshot(Hdf5Writer& file, const std::string& group, const Snapshot& state);
template <class T>
Snapshot read_snapshot(const Hdf5Reader& file, const std::string& group, std::size_t bodies);

/// One dataset per field of StepRecord; those of the tracked tool only if it was loaded.
void write_steps(Hdf5Writer& file, const std::string& group, const std::vector<StepRecord>& steps);
std::vector<StepRecord> read_steps(const Hdf5Reader& file, const std::string& group);

/// "frame-000007.h5".
std::string frame_file_name(std::size_t index);

}  // namespace repose
