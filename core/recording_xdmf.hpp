#pragma once
/// The XDMF text beside run.h5: ParaView and VisIt open it and read the HDF5 files it points to.
#include <cstddef>
#include <string>
#include <vector>

#include "core/periodic.hpp"

namespace repose {

/// A temporal collection of point clouds, one per frame, each body a point at its centre of mass, with radius [m] (0 for
/// tools and fixed bodies), shape, material and role (indices as in run.h5), velocity, angular velocity and orientation
/// (scalar first, as ParaView's glyphs take it). A periodic cell stands in <Information> elements, its bounds in m. Paths are relative to the folder of run.h5.
std::string xdmf_text(std::size_t bodies, const std::vector<double>& frame_times, const PeriodicCell& periodic);

}  // namespace repose
