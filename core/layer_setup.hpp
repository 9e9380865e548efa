#pragma once
/// How a layer of powder is spread over a bed and where its surface is measured: the `layer` block of a scene.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/math.hpp"

namespace repose {

/// The bed settles without the spreader; then the spreader, a roller or a blade of the scene, travels along +x. Its place
/// in the scene (`position`, `motion`) holds only for `repose run`; here it is put where this says.
struct LayerSetup {
  /// Of a roller about its axis: `rolling` turns so that a point of its surface stands still at the lowest place
  /// (angular velocity +speed/R about y, times rotation_ratio), `counter_rotating` the other way round.
  enum class Rotation : std::uint8_t { none, rolling, counter_rotating };
  /// What the gap is measured from: the mean height of the settled surface within the region, or the build plate.
  enum class GapFrom : std::uint8_t { bed, plate };

  std::string spreader;                ///< name of a tool of the kind roller or blade
  double plate = 0;                    ///< height of the build plate [m]; heights of surfaces are above it
  double gap = 0;                      ///< from the reference up to the lowest line of the spreader [m]; above a plate > 0
  GapFrom gap_from = GapFrom::bed;
  double speed = 0;                    ///< along +x [m/s], > 0
  Rotation rotation = Rotation::none;
  double rotation_ratio = 1;           ///< surface speed over travel speed, > 0
  std::optional<double> from;          ///< x of the lowest line at the start [m]; else as near to the powder as it can be
  double to = 0;                       ///< x of the lowest line at the end [m]
  double rest = 0;                     ///< time after the travel [s], >= 0
  double settle = 0;                   ///< longest time that the bed is given to come to rest [s], > 0
  double settle_time_step = 0;         ///< [s], > 0
  Vec2 lower = Vec2::Zero(), upper = Vec2::Zero();  ///< the region that is measured (x, y) [m]
  double cell = 0;                     ///< of the height grid [m], > 0
  double square = 0;                   ///< edge of the squares whose highest grain is taken [m], > 0
  std::vector<double> further_squares; ///< edges of squares that are told beside these, in figures alone [m]
  double s_filter = 0;                 ///< nesting index of the Gaussian S filter [m]; 0: none
  double l_filter = 0;                 ///< nesting index of the Gaussian L filter [m]; 0: none
};

}  // namespace repose
