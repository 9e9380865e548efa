#pragma once
/// When and where two ensembles of runs part: the first frame and cell in which they differ by more than runs of one
/// ensemble do among each other.
///
/// Each run is a film of cells. In every cell of every frame
///   T = |mean_a - mean_b| / (se + s0),   se^2 = s_a^2/n_a + s_b^2/n_b,
/// where s0 is the median standard error (of both ensembles thrown together) over the cells of the same kind: it keeps
/// cells that hardly vary from shouting. The largest T of the film is compared with those of all ways to deal the runs
/// into two ensembles anew (a drawn set of them if they are too many): max-T test of Westfall & Young (1993). A cell has parted
/// if at most a share alpha of the ways have a T as large anywhere. So a film without any difference is said to part
/// with probability alpha at most, however many cells and frames it has and however these depend on each other. Runs of equal seeds
/// resemble each other at the beginning, which only makes false alarms rarer.
///
/// Cost: ways * runs * length of the film.
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace repose {

struct PartingPlace {
  std::size_t frame = 0, cell = 0;
  double statistic = 0;          ///< T
  double p = 1;                  ///< corrected for all cells and frames
  double mean_a = 0, mean_b = 0; ///< in the cell
  double se = 0;                 ///< of their difference
};

struct Parting {
  std::optional<PartingPlace> first;    ///< nullopt: they do not part
  PartingPlace largest;                 ///< of the whole film
  double least_p = 1;                   ///< the smallest p that so few runs can give: above alpha nothing can be told
  std::size_t ways = 0;
};

/// A film: frames * cells values, frame by frame.
using Film = std::vector<double>;

/// `kind[cell]`: cells that share a unit have the same number. Throws Error unless every film has the same length, a
/// multiple of the number of cells, and each ensemble has at least two runs. `alpha` in (0, 1).
Parting first_parting(std::span<const Film> a, std::span<const Film> b, std::span<const int> kind, double alpha = 0.05);

}  // namespace repose
