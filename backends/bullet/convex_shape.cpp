#include "backends/bullet/convex_shape.hpp"

#include <BulletCollision/CollisionShapes/btConvexInternalShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <algorithm>
#include <cmath>

#include "backends/bullet/bullet_math.hpp"

namespace repose::bullet {

namespace {

constexpr double ellipsoid_margin = 0.9;  // of its smallest radius of curvature; beyond 1 the core would fold

// Bullet's GJK gives up where its simplex spans less than a fixed volume (1e-8). On grains of size 1 that leaves the normal
// wrong by up to 1e-2; magnified by this power of two, by less than 1e-5.
constexpr double magnified = 1024;

constexpr double proven_to = 3e-4;    // of shapes of size 1: what a normal that is off by 2e-4 costs on a flat side
constexpr double nearest_cores = 1e-3;  // below, the line that joins them has too few digits for a normal

}  // namespace

/// The core of a primitive, with its margin.
class ConvexShape final : public btConvexInternalShape {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  ConvexShape(const Primitive& primitive, double margin) : primitive_(primitive) {
    m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE;
    setMargin(margin);
  }

  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& direction) const override {
    const Vec3 d = from_bullet(direction);
    return to_bullet<btVector3>(std::visit([&](const auto& shape) { return core(shape, d); }, primitive_));
  }
  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* directions, btVector3* points,
                                                         int count) const override {
    for (int i = 0; i < count; ++i) points[i] = localGetSupportingVertexWithoutMargin(directions[i]);
  }
  void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }  // bodies bring their own
  const char* getName() const override { return "Repose"; }

 private:
  Vec3 core(const Sphere&, const Vec3&) const { return Vec3::Zero(); }
  Vec3 core(const Ellipsoid& e, const Vec3& d) const {
    const Vec3 stretched = e.semi_axes.cwiseProduct(d);
    const double reach = stretched.norm();
    if (!(reach > 0)) return Vec3(e.semi_axes.x() - m_collisionMargin, 0, 0);
    return e.semi_axes.cwiseProduct(stretched) / reach - m_collisionMargin / d.norm() * d;
  }
  Vec3 core(const RoundCone& c, const Vec3& d) const {
    const double length = d.norm(), a = c.radius_a - m_collisionMargin, b = c.radius_b - m_collisionMargin;
    const bool second = d.x() * c.length + (b - a) * length > 0;
    const double radius = second ? b : a;
    const Vec3 centre(second ? c.length : 0.0, 0, 0);
    return radius > 0 && length > 0 ? Vec3(centre + radius / length * d) : centre;
  }
  Vec3 core(const Box& box, const Vec3& d) const {
    Vec3 corner = box.half_extents;
    for (int k = 0; k < 3; ++k)
      if (d[k] < 0) corner[k] = -corner[k];
    return corner;
  }
  Vec3 core(const Cylinder& c, const Vec3& d) const {
    return rim(c.radius, d, d.z() < 0 ? -c.half_height : c.half_height);
  }
  Vec3 core(const Cone& c, const Vec3& d) const {
    if (c.height * d.z() > c.radius * std::hypot(d.x(), d.y())) return {0, 0, c.height};
    return rim(c.radius, d, 0);
  }
  template <class Other>
  Vec3 core(const Other&, const Vec3&) const {
    return Vec3::Zero();  // convex_shape() makes none of these
  }

  static Vec3 rim(double radius, const Vec3& d, double z) {
    const double across = std::hypot(d.x(), d.y());
    return across > 0 ? Vec3(radius * d.x() / across, radius * d.y() / across, z) : Vec3(0, 0, z);
  }

  Primitive primitive_;
};

void ConvexShapeDeleter::operator()(ConvexShape* shape) const { delete shape; }

namespace {

struct MarginOf {
  double operator()(const Sphere& s) const { return s.radius; }
  double operator()(const Ellipsoid& e) const {
    const double shortest = e.semi_axes.minCoeff();
    return ellipsoid_margin * shortest * shortest / e.semi_axes.maxCoeff();
  }
  double operator()(const RoundCone& c) const { return std::min(c.radius_a, c.radius_b); }
  double operator()(const Box&) const { return 0; }
  double operator()(const Cylinder&) const { return 0; }
  double operator()(const Cone&) const { return 0; }
  template <class Other>
  double operator()(const Other&) const {
    return -1;
  }
};

btTransform transform(const PlacedShape& placed) {
  return btTransform(to_bullet<btMatrix3x3>(placed.rotation), magnified * to_bullet<btVector3>(placed.position));
}

}  // namespace

ConvexShapePointer convex_shape(const Primitive& primitive, double scale) {
  const Primitive sized = scaled(primitive, magnified * scale);
  const double margin = std::visit(MarginOf{}, sized);
  return ConvexShapePointer(margin < 0 ? nullptr : new ConvexShape(sized, margin));
}

namespace {

/// How far the planes across `normal` (from a to b) that touch the two cores stand apart, less both margins. Never more than
/// the gap, and equal to it for the true normal alone: what proves an answer.
double separation_along(const Vec3& normal, const PlacedShape& a, const PlacedShape& b) {
  const auto reach = [](const PlacedShape& placed, const Vec3& direction) {
    const Vec3 local = placed.rotation.transpose() * direction;
    const Vec3 point = from_bullet(placed.shape->localGetSupportingVertexWithoutMargin(to_bullet<btVector3>(local)));
    return direction.dot(magnified * placed.position) + local.dot(point) + placed.shape->getMargin();
  };
  return -(reach(a, normal) + reach(b, -normal)) / magnified;
}

btPointCollector nearest_points(const PlacedShape& a, const PlacedShape& b, double reach, const btVector3& start) {
  btVoronoiSimplexSolver simplex;
  btGjkEpaPenetrationDepthSolver depth;
  btGjkPairDetector detector(a.shape, b.shape, &simplex, &depth);
  detector.setCachedSeparatingAxis(start);
  btGjkPairDetector::ClosestPointInput input;
  input.m_transformA = transform(a);
  input.m_transformB = transform(b);
  input.m_maximumDistanceSquared = reach * reach;
  btPointCollector found;
  detector.getClosestPoints(input, found, nullptr);
  return found;
}

}  // namespace

Touch touch(const PlacedShape& a, const PlacedShape& b, double margin, dvi::ContactPoint& out) {
  const double margins = a.shape->getMargin() + b.shape->getMargin();
  // From some starts Bullet's GJK returns the distance with a normal that is not its own, once in several thousand pairs: the
  // answer is proven, or asked for again from elsewhere, or left to the caller.
  for (const Vec3& start : {Vec3(0, 1, 0), Vec3(b.position - a.position), Vec3(1, 0.3, -0.2), Vec3(-0.2, 0.1, 1)}) {
    const btPointCollector found = nearest_points(a, b, margins + magnified * margin, to_bullet<btVector3>(start));
    if (!found.m_hasResult) return Touch::apart;
    // Bullet's normal points from b to a, its point lies on b.
    out.normal = -from_bullet(found.m_normalOnBInWorld);
    out.gap = found.m_distance / magnified;
    out.point = from_bullet(found.m_pointInWorld) / magnified - 0.5 * out.gap * out.normal;
    const double cores = out.gap + margins / magnified;
    if (!(cores > nearest_cores) || !out.normal.allFinite() || !out.point.allFinite()) return Touch::no_answer;
    if (out.gap - separation_along(out.normal, a, b) <= proven_to) return out.gap <= margin ? Touch::found : Touch::apart;
  }
  return Touch::no_answer;
}

}  // namespace repose::bullet
