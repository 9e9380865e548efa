#pragma once
/// Set-up effects: the things themselves are not what the scene says. Each is a change of the scene, made while it is
/// read (keys of its `effects` block), so that every backend, every check and every measurement sees the changed scene.
///
/// All throw Error, naming the key, if the scene has nothing that they could change.
#include <string>

#include "core/math.hpp"

namespace repose {

struct Scene;

/// The ground vibrates vertically: z(t) += amplitude (sin(2 pi frequency t + phase) - sin(phase)), for tools that
/// things rest on (base, plate, floor, box, cup) and bodies with `fixed: true`. Grains leave it where amplitude (2 pi
/// frequency)^2 exceeds gravity. One that vibrates already is an Error.
struct BaseVibration {
  double amplitude = 0;  ///< [m], >= 0
  double frequency = 0;  ///< [Hz], >= 0
  double phase = 0;      ///< [rad]
};

/// Velocity and angular velocity of every prescribed motion times `factor`; start, stop and vibrations stay. So does LayerSetup::speed, with which the
/// rotation of the spreader grows; its way stays, and takes another time.
struct MovingWallSpeed {
  double factor = 1;  ///< [1]; > 0 for a layer
};

/// `aspect` of every population times this: GrainProportions::with_aspect.
struct GrainShapeFactor {
  double aspect = 1;  ///< [1], > 0
};

/// Sizes x of every population become  mean_factor (m + sd_factor (x - m)),  m the law's mean (fixed, normal, table)
/// before truncation; log-normal: ln x becomes ln(mean_factor median) + sd_factor ln(x / median). The range moves
/// along. So mean_factor alone changes scale, sd_factor alone the relative spread. Sizes that would reach zero are an
/// Error.
struct SizeDistributionFactors {
  double mean_factor = 1;  ///< [1], > 0
  double sd_factor = 1;    ///< [1], > 0
};

/// Moments of inertia of every body and grain that moves freely, times a factor about each axis of the shape's own
/// frame (it goes to the principal axis nearest to that axis). A ball of factor f rolls down an incline with g sin / (1
/// + 2f/5).
struct InertiaFactor {
  Vec3 factor = Vec3::Ones();  ///< [1], each > 0
};

/// The centre of mass of every body and grain that moves freely lies `offset` from that of its shape, in the axes of
/// the shape's own frame. Mass and moments about the centre of mass stay. The shape stands where the scene puts it.
/// Every grain then has a shape of its own, about 1 kB.
struct CenterOfMassOffset {
  Vec3 offset = Vec3::Zero();  ///< [m]
};

/// Cohesion of every pair times exp((temperature - 293.15 K) / scale).
struct ThermalSoftening {
  double temperature = 293.15;  ///< [K], > 0
  double scale = 1;             ///< [K], not 0
};

/// `friction` of every pair that holds a material which only tools and fixed or prescribed bodies have.
struct WallFriction {
  double friction = 0;  ///< [1], >= 0
};

void apply(const BaseVibration& effect, Scene& scene);
void apply(const MovingWallSpeed& effect, Scene& scene);
void apply(const GrainShapeFactor& effect, Scene& scene);
void apply(const SizeDistributionFactors& effect, Scene& scene);
void apply(const InertiaFactor& effect, Scene& scene);
void apply(const CenterOfMassOffset& effect, Scene& scene);
void apply(const ThermalSoftening& effect, Scene& scene);
void apply(const WallFriction& effect, Scene& scene);

inline constexpr double softening_reference = 293.15;  ///< T_ref [K]

/// Only tools and fixed or prescribed bodies are made of it.
bool is_wall_material(const Scene& scene, const std::string& material);

}  // namespace repose
