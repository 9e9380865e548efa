#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/io/File.h>

#include <cstdint>
#include <fstream>

#include "analysis/height_grid.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

constexpr double micrometres = 1e6;  // in a metre
constexpr const char* cells_key = "cells";
constexpr const char* origin_key = "origin";
constexpr const char* cell_key = "cell";
constexpr const char* name_of_surfaces = "surface.vdb";

openvdb::FloatGrid::Ptr to_vdb(const NamedGrid& named) {
  const HeightGrid& grid = named.grid;
  openvdb::FloatGrid::Ptr out = openvdb::FloatGrid::create(0.0f);
  out->setName(named.name);
  out->setGridClass(openvdb::GRID_UNKNOWN);
  // OpenVDB refuses cells of a few micrometres as having no volume if they are given in metres.
  openvdb::math::Transform::Ptr transform = openvdb::math::Transform::createLinearTransform(grid.cell * micrometres);
  const Vec3 first(grid.origin.x() + 0.5 * grid.cell, grid.origin.y() + 0.5 * grid.cell, grid.plate);
  transform->postTranslate({first.x() * micrometres, first.y() * micrometres, first.z() * micrometres});
  out->setTransform(transform);
  // The transform is a product of these; kept apart they come back bit for bit.
  out->insertMeta(cells_key, openvdb::Vec3IMetadata({grid.nx, grid.ny, 1}));
  out->insertMeta(origin_key, openvdb::Vec3DMetadata({grid.origin.x(), grid.origin.y(), grid.plate}));
  out->insertMeta(cell_key, openvdb::DoubleMetadata(grid.cell));
  out->insertMeta("unit", openvdb::StringMetadata("m"));
  openvdb::FloatGrid::Accessor voxels = out->getAccessor();
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i)
      if (!grid.is_hole(i, j)) voxels.setValueOn({i, j, 0}, grid.at(i, j));
  return out;
}

/// OpenVDB gives every file a random UUID, `name`; one that is made of the content (RFC 9562, version 8) lets equal surfaces be equal files.
void name_by_content(const std::filesystem::path& file, const std::string& name) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.exceptions(std::ios::badbit | std::ios::failbit);
  std::string bytes(std::filesystem::file_size(file), '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  const std::size_t at = bytes.find(name);
  if (name.empty() || at == std::string::npos) throw std::runtime_error("its header has no UUID");
  bytes.erase(at, name.size());
  const std::uint64_t high = checksum(bytes), low = checksum(bytes + name_of_surfaces);
  const std::string uuid = fmt::format("{:08x}-{:04x}-8{:03x}-{:04x}-{:012x}", high >> 32, (high >> 16) & 0xffff, high & 0xfff,
                                       0x8000 | ((low >> 48) & 0x3fff), low & 0xffffffffffff);
  if (uuid.size() != name.size()) throw std::runtime_error("its UUID has another form");
  stream.seekp(static_cast<std::streamoff>(at));
  stream.write(uuid.data(), static_cast<std::streamsize>(uuid.size()));
}

HeightGrid from_vdb(const openvdb::FloatGrid& in) {
  const openvdb::Vec3i cells = in.metaValue<openvdb::Vec3i>(cells_key);
  const openvdb::Vec3d origin = in.metaValue<openvdb::Vec3d>(origin_key);
  HeightGrid grid;
  grid.origin = {origin.x(), origin.y()};
  grid.plate = origin.z();
  grid.cell = in.metaValue<double>(cell_key);
  grid.nx = cells.x();
  grid.ny = cells.y();
  if (grid.nx < 1 || grid.ny < 1) throw std::runtime_error("a grid without cells");
  grid.height.assign(static_cast<std::size_t>(grid.nx) * static_cast<std::size_t>(grid.ny), HeightGrid::hole);
  for (auto voxel = in.cbeginValueOn(); voxel; ++voxel) {
    const openvdb::Coord at = voxel.getCoord();
    if (at.x() < 0 || at.x() >= grid.nx || at.y() < 0 || at.y() >= grid.ny || at.z() != 0)
      throw std::runtime_error("a voxel outside the grid");
    grid.height[grid.index(at.x(), at.y())] = *voxel;
  }
  return grid;
}

}  // namespace

void write_vdb(const std::filesystem::path& file, const std::vector<NamedGrid>& grids) {
  openvdb::initialize();
  openvdb::GridPtrVec all;
  for (const NamedGrid& named : grids) all.push_back(to_vdb(named));
  const std::filesystem::path aside = file.string() + ".aside";
  try {
    openvdb::io::File out(aside.string());
    out.write(all);
    out.close();
    name_by_content(aside, out.getUniqueTag());
    std::filesystem::rename(aside, file);
  } catch (const std::exception& problem) {
    std::error_code ignored;
    std::filesystem::remove(aside, ignored);
    throw Error(file.string(), std::string("cannot be written: ") + problem.what(), "check the folder and the disk",
                Error::Kind::simulation);
  }
}

std::vector<NamedGrid> read_vdb(const std::filesystem::path& file) {
  openvdb::initialize();
  try {
    openvdb::io::File in(file.string());
    in.open();
    const openvdb::GridPtrVecPtr grids = in.getGrids();
    std::vector<NamedGrid> result;
    for (const openvdb::GridBase::Ptr& grid : *grids) {
      const auto heights = openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
      if (!heights) throw std::runtime_error("a grid that is not of floats");
      result.push_back({grid->getName(), from_vdb(*heights)});
    }
    return result;
  } catch (const std::exception& problem) {
    throw Error(file.string(), std::string("is not a surface: ") + problem.what(), "give a surface.vdb of `repose layer`");
  }
}

}  // namespace repose
