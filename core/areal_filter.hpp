#pragma once
/// What a Gaussian filter of a surface can be, for those who read it and those who apply it.

namespace repose {

/// Least nesting index, in cells of the grid. Below, all its weight is on one cell: an S filter keeps everything, an L filter nothing.
inline constexpr double least_filter_cells = 3;

}  // namespace repose
