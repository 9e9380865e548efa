#pragma once
/// The contact problem of one time step, as plain data: any solver takes it, no solver knows a scene.
///
/// Find impulses g_i of the contacts i and the velocities
///   v = v_free + M^-1 sum_i J_i' g_i
/// such that for every contact, with u = J v (relative velocity of b against a, six rows below),
///   -( u + e_n (bias + mu |u_t| + rho |u_r| + sigma |u_s|) )  in  N_K(g)            (exact law; De Saxce's correction)
/// where K = { g : p = g_n + cohesion >= 0, |g_t| <= mu p, |g_r| <= rho p, |g_s| <= sigma p } and N_K is its normal cone.
/// The relaxed law leaves the three corrections out (Anitescu & Tasora): a convex programme, which makes sliding contacts part.
///
/// Rows of a contact, in the frame (n, t1, t2) of its normal:
///   0 normal, 1-2 sliding: relative velocity at the contact point;  impulse [N s]
///   3-4 rolling, 5 spinning: relative angular velocity times `arm`, so that all rows are velocities; impulse times arm is
///   the moment. rho and sigma are therefore dimensionless here: (arm of the resisting moment) / arm.
/// Two extensions, off by default. Compliance eps of a contact: u_n is replaced by u_n + eps g_n. Orthotropic friction: with
/// `across` = r, (g_1)^2 + (g_2 / r)^2 <= (mu p)^2, and |u_t| is replaced by |(u_1, r u_2)|.
/// The impulse acts on b, its opposite on a. The unit system is the caller's.
#include <array>
#include <cstdint>
#include <vector>

#include "core/math.hpp"

namespace repose::dvi {

using Impulse = std::array<double, 6>;  ///< rows as above

/// Inverse mass and inertia of a body. Prescribed bodies: all zero; those that yield along z alone: all but `lift`.
struct InverseMass {
  double mass = 0;
  std::array<double, 6> inertia{};  ///< world frame: xx, xy, xz, yy, yz, zz
  double lift = 0;                  ///< added to `mass` for forces along z
};

struct ConeContact {
  std::int32_t a = 0, b = 0;      ///< bodies; at most one of them prescribed
  Vec3 normal = Vec3::UnitZ();    ///< unit, from a to b
  Vec3 arm_a = Vec3::Zero();      ///< from the centre of a to the contact point
  Vec3 arm_b = Vec3::Zero();
  double bias = 0;                ///< added to u_n: gap / h (velocity that closes the gap), or e u_n- where an impact is restored
  double friction = 0;            ///< mu
  double rolling = 0;             ///< rho
  double spinning = 0;            ///< sigma
  double arm = 1;                 ///< length that turns angular rows into velocities, > 0
  double cohesion = 0;            ///< impulse that the contact can hold in tension, c h >= 0
  double compliance = 0;          ///< eps >= 0: velocity per impulse by which the contact gives way; 0: rigid
  Vec3 along = Vec3::Zero();      ///< first tangent, unit, normal to `normal`; zero: that of tangent_frame()
};

/// mu of a contact at the slip speed s, for problems in which it follows the slip that the impulses leave:
///   mu(s) = max(0, friction + slope ln(max(s / speed, 1e-6))),  slope > 0.
struct SlipLaw {
  double slope = 0;               ///< 0: off, every contact keeps ConeContact::friction
  double speed = 1;
  std::vector<double> friction;   ///< of each contact, at s = speed; ConeContact::friction is the first guess
};

struct ConeProblem {
  /// Bodies: first the dynamic ones, then the prescribed ones.
  std::int32_t dynamic_bodies = 0;
  std::vector<InverseMass> inverse_mass;
  std::vector<Vec3> velocity;           ///< in: free velocity v + M^-1 h f (prescribed: the given one)
  std::vector<Vec3> angular_velocity;
  std::vector<ConeContact> contacts;
  double across = 1;              ///< r: friction along the second tangent / along the first, > 0
  SlipLaw slip_law;
};

/// Two unit vectors that make (n, t1, t2) right-handed; a function of n alone.
inline void tangent_frame(const Vec3& n, Vec3& t1, Vec3& t2) {
  // Duff et al. 2017, "Building an orthonormal basis, revisited": no branch, no loss of digits near the poles.
  const double sign = n.z() < 0 ? -1.0 : 1.0;
  const double a = -1.0 / (sign + n.z());
  const double b = n.x() * n.y() * a;
  t1 = Vec3(1.0 + sign * n.x() * n.x() * a, sign * b, -sign * n.x());
  t2 = Vec3(b, sign + n.y() * n.y() * a, -n.y());
}

/// The tangents of a contact: rows 1 and 2, and 3 and 4.
inline void contact_frame(const ConeContact& c, Vec3& t1, Vec3& t2) {
  if (c.along.isZero(0)) {
    tangent_frame(c.normal, t1, t2);
    return;
  }
  t1 = c.along;
  t2 = c.normal.cross(c.along);
}

}  // namespace repose::dvi
