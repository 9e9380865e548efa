#pragma once
/// Contact points of placed primitives as DART's collision detector finds them: FCL, with primitive shapes.
///
/// FCL tells of pairs that overlap, nothing of those that are apart, and one point a pair but for two boxes. It is
/// asked where that describes the contact fully (`fcl_finds`); a cylinder that stands on its end, a mesh or a funnel is
/// not among these. So that bodies that just touch are in contact, whatever the last digit, FCL is given shapes that
/// are thicker by `skin` and the gap is told without it. Lengths are in the caller's unit, in which a grain is of the
/// order of one.
#include <memory>
#include <vector>

#include "core/shape.hpp"

namespace repose::dart {

/// True if FCL's contacts of such a pair are the whole truth: spheres with spheres, boxes and half-spaces, ellipsoids
/// with half-spaces, boxes with boxes.
bool fcl_finds(const Primitive& a, const Primitive& b);

constexpr double skin = 1e-6;

struct FclContact {
  int a = 0, b = 0;             ///< parts, a < b
  Vec3 point = Vec3::Zero();    ///< midway between the two surfaces
  Vec3 normal = Vec3::UnitZ();  ///< unit, from a to b
  double gap = 0;               ///< < 0: overlap; at most 2 skins
};

class FclContacts {
 public:
  FclContacts();
  ~FclContacts();

  /// Adds a part of `body`; parts are numbered from 0. Pairs of one body, or of two immovable ones, never touch.
  void add(const Primitive& primitive, double scale, int body, bool movable);
  /// Where the primitive's own frame is. An absent part touches nothing.
  void place(int part, const Vec3& position, const Mat3& rotation, bool present);
  /// Every contact of pairs that `fcl_finds` is true for, by part, then in FCL's order: a function of the places alone.
  const std::vector<FclContact>& find();

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
  std::vector<FclContact> found_;
};

}  // namespace repose::dart
