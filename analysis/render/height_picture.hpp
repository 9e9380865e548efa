#pragma once
/// Height maps as shaded pictures.
#include <string>
#include <vector>

#include "analysis/render/image.hpp"

namespace repose {

/// Heights over a regular grid, row by row from the lowest y on; NaN is a hole.
struct HeightPanel {
  std::string title;
  int nx = 0, ny = 0;
  const std::vector<float>* height = nullptr;  ///< [m], nx * ny
};

/// The panels under one another (side by side if they are taller than wide), all on one colour scale from `low` to `high` [m], lit
/// from the upper left as a landscape would be, with a colour bar and a scale bar; holes are black. `cell`: edge of a cell [m].
/// Colours are those of cividis (Nunez et al. 2018), which colour-blind people see alike; x runs to the right, y up.
/// Throws Error for panels of different size or an empty scale.
Image height_picture(const std::vector<HeightPanel>& panels, double cell, double low, double high, const std::string& quantity);

}  // namespace repose
