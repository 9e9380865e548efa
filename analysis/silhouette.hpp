#pragma once
/// Exact outlines of grains: how high a grain reaches above a line of sight or above a point of the ground.
///
/// A part is an ellipsoid (a sphere included) or the hull of two spheres, which is the union of the spheres between
/// them. Both have closed-form tops. With horizontal offset q from the centre:
///   ellipsoid x^T S^-1 x <= 1, S = [[A, b], [b^T, c]] (horizontal, vertical):
///       top(q) = b^T A^-1 q + sqrt((c - b^T A^-1 b) (1 - q^T A^-1 q));
///   hull, spheres of centre p + t e and radius r + t s, t in [0, 1]:
///       top = max over t of t e_z + sqrt((r + t s)^2 - |q - t e_h|^2), concave in t.
/// Seen from the side, q is one number (the coordinate across the line of sight); from above it is a point.
#include <vector>

#include "core/model.hpp"

namespace repose {

/// One convex piece of a grain in the world frame.
struct GrainPart {
  int body = 0;               ///< index into Model::bodies
  bool is_hull = false;       ///< else an ellipsoid
  Vec3 centre = Vec3::Zero(); ///< of the ellipsoid, or of the first sphere [m]
  Mat3 shape = Mat3::Zero();  ///< ellipsoid: S [m^2]
  Vec3 axis = Vec3::Zero();   ///< hull: from the first centre to the second [m]
  double radius_a = 0, radius_b = 0;  ///< hull [m]

  double reach() const;       ///< of the part from `centre`, an upper bound [m]
};

/// The parts of the given bodies in the given state. Throws Error for a primitive that no grain shape has.
std::vector<GrainPart> grain_parts(const Model& model, const Snapshot& state, const std::vector<int>& bodies);

/// Height [m] that the part reaches over the ground point (x, y); -infinity if it does not cover the point.
double top_over_point(const GrainPart& part, const Vec2& point);

/// What a part looks like from the side, ready to be asked at many columns. Screen coordinate: across . (x, y).
class SideView {
 public:
  /// `across`: unit horizontal vector, at right angles to the line of sight.
  SideView(const GrainPart& part, const Vec2& across);
  /// Height [m] that the part reaches in the column at screen coordinate `s` [m]; -infinity if it is not there.
  double top(double s) const;
  double left() const { return left_; }    ///< [m] smallest screen coordinate
  double right() const { return right_; }  ///< [m] largest

 private:
  bool is_hull_;
  double s_, z_;                         // centre on the screen
  double a_ = 0, b_ = 0, c_ = 0;         // ellipse: A, b, c
  double es_ = 0, ez_ = 0, ra_ = 0, rb_ = 0;  // hull
  double left_, right_;
};

}  // namespace repose
