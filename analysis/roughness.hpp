#pragma once
/// Roughness of a surface after ISO 25178-2, and what has to be done to it before.
///
/// 1. F operator: the least-squares plane is taken away (all holes left out; `repose layer` has none, for it
///    looks at the surface with the plate in them, see on_plate).
/// 2. S filter: areal Gaussian of nesting index lambda_s (ISO 16610-61), weight exp(-pi (r / (alpha lambda))^2), alpha =
///    sqrt(ln 2 / pi) = 0.4697, cut off at one lambda; keeps what is longer. 0: none.
/// 3. L filter: the same mean with lambda_l is taken away; keeps what is shorter. 0: none, the plane only.
/// Near edges and holes the weights are those of the cells that are there, normalised. Then, over the n cells left, z from their mean:
///   Sa = mean |z|   Sq = sqrt(mean z^2)   Sp = max z   Sv = -min z   Sz = Sp + Sv   Ssk = mean z^3 / Sq^3   Sku = mean z^4 / Sq^4
///   Sal = shortest lag at which the autocorrelation has fallen to 0.2
#include <array>
#include <optional>
#include <vector>

#include "analysis/height_grid.hpp"

namespace repose {

/// z = height + slope . (x - middle of the grid)
struct Plane {
  double height = 0;           ///< [m]
  Vec2 slope = Vec2::Zero();   ///< [1]
};

/// Least squares over the cells that are no holes. Throws Error if they do not fix a plane.
Plane fit_plane(const HeightGrid& surface);
HeightGrid without(const HeightGrid& surface, const Plane& plane);

/// The areal Gaussian mean of nesting index `lambda` [m]; holes stay holes. Throws Error below least_filter_cells (core/areal_filter.hpp) cells.
HeightGrid gaussian_mean(const HeightGrid& surface, double lambda);

/// How a surface is prepared.
struct RoughnessFilter {
  double s = 0, l = 0;  ///< nesting indices [m]; 0: none
};
HeightGrid prepared_surface(const HeightGrid& surface, const RoughnessFilter& filter);

struct Roughness {
  double Sa = 0, Sq = 0, Sp = 0, Sv = 0, Sz = 0;  ///< [m]
  std::optional<double> Ssk, Sku;                 ///< [1]; nullopt for a flat surface, which has none
};
/// Of a prepared surface. Throws Error if every cell is a hole.
Roughness roughness(const HeightGrid& prepared);

/// Sal [m] of a prepared surface, linear between lags; nullopt if the surface is flat, or the autocorrelation stays above 0.2 up to half the
/// shorter side of the grid, or up to the lag within which lags times cells are `most_products`: 100 cells on a grid of 6 million. Each product takes
/// about a nanosecond, so that the search ends within minutes on any grid.
std::optional<double> autocorrelation_length(const HeightGrid& prepared, double most_products = 1e11);

/// Standard errors from the size of the region: blocks of edge `block` [m] are drawn again and again with replacement
/// (200 times, always the same draws), and the scatter of what they give is told. Blocks longer than the autocorrelation
/// length are nearly independent. nullopt if fewer than eight blocks fit. Extremes have no such error.
struct RoughnessError {
  double mean = 0, Sa = 0, Sq = 0;  ///< `mean`: of the heights of `surface` [m]
  std::optional<double> Ssk, Sku;   ///< nullopt for a flat surface
  int blocks = 0;
};
std::optional<RoughnessError> block_bootstrap(const HeightGrid& surface, const HeightGrid& prepared, double block);

/// Shares of the quantiles that are told: 0.1 % to 99.9 %.
inline constexpr std::array<double, 9> told_shares{0.001, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 0.999};

/// What a set of heights is like.
struct HeightFigures {
  std::size_t n = 0;
  double mean = 0, sd = 0, min = 0, max = 0;             ///< [m]
  std::array<double, told_shares.size()> quantile{};     ///< [m], linear between order statistics
};
/// NaN is left out; all zero if nothing is left.
HeightFigures height_figures(std::vector<double> heights);
HeightFigures height_figures(const HeightGrid& surface);

}  // namespace repose
