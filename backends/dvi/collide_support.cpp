#include "backends/dvi/collide_support.hpp"

namespace repose::dvi {

Vec3 ConvexBody::support(const Vec3& d) const {
  switch (kind) {
    case Kind::ball:
      return centre;
    case Kind::triangle: {
      const double p0 = d.dot(points[0] - centre), p1 = d.dot(points[1] - centre), p2 = d.dot(points[2] - centre);
      return p0 >= p1 ? (p0 >= p2 ? points[0] : points[2]) : (p1 >= p2 ? points[1] : points[2]);
    }
    case Kind::round_cone: {
      const double length = d.norm();
      const bool second = d.dot(points[1] - points[0]) + (radii[1] - radii[0]) * length > 0;
      const double r = second ? radii[1] : radii[0];
      const Vec3& c = second ? points[1] : points[0];
      return r > 0 && length > 0 ? Vec3(c + (r / length) * d) : c;
    }
    default:
      break;
  }
  const Vec3 local = rotation.transpose() * d;
  Vec3 p = Vec3::Zero();
  if (kind == Kind::box) {
    for (int i = 0; i < 3; ++i) p[i] = local[i] < 0 ? -size[i] : size[i];
  } else if (kind == Kind::ellipsoid) {
    const Vec3 scaled_direction = size.cwiseProduct(local);
    const double h = scaled_direction.norm();
    if (h > 0) p = size.cwiseProduct(scaled_direction) / h;
  } else {
    const double across = std::sqrt(local.x() * local.x() + local.y() * local.y());
    if (across > 0) p = Vec3(size.x() * local.x() / across, size.x() * local.y() / across, 0);
    if (kind == Kind::cylinder) {
      p.z() = local.z() < 0 ? -size.z() : size.z();
    } else {
      // Cone: the apex or the rim. The centre is a quarter of the height above the base.
      if (size.z() * local.z() > size.x() * across)
        p = Vec3(0, 0, 0.75 * size.z());
      else
        p.z() = -0.25 * size.z();
    }
  }
  return centre + rotation * p;
}

ConvexBody convex(const PlacedSphere& sphere) {
  ConvexBody body;
  body.centre = sphere.centre;
  body.margin = body.extent = sphere.radius;
  return body;
}

ConvexBody convex(const PlacedEllipsoid& ellipsoid) {
  ConvexBody body;
  body.kind = ConvexBody::Kind::ellipsoid;
  body.centre = ellipsoid.centre;
  body.rotation = ellipsoid.rotation;
  body.size = ellipsoid.semi_axes;
  body.extent = ellipsoid.semi_axes.maxCoeff();
  return body;
}

ConvexBody convex(const PlacedRoundCone& cone) {
  ConvexBody body;
  body.kind = ConvexBody::Kind::round_cone;
  body.centre = cone.centre(0.5 * cone.length);
  body.points = {cone.start, cone.centre(cone.length), cone.start};
  body.margin = std::min(cone.radius_start, cone.radius_end);
  body.radii = {cone.radius_start - body.margin, cone.radius_end - body.margin};
  body.extent = 0.5 * cone.length + std::max(cone.radius_start, cone.radius_end);
  return body;
}

ConvexBody convex(const PlacedBox& box) {
  ConvexBody body;
  body.kind = ConvexBody::Kind::box;
  body.centre = box.centre;
  body.rotation = box.rotation;
  body.size = box.half_extents;
  body.extent = box.half_extents.norm();
  return body;
}

ConvexBody convex(const Cone& cone, const PlacedPrimitive& placed) {
  ConvexBody body;
  body.kind = ConvexBody::Kind::cone;
  const double r = placed.scale * cone.radius, h = placed.scale * cone.height;
  body.centre = placed.position + 0.25 * h * placed.rotation.col(2);
  body.rotation = placed.rotation;
  body.size = {r, r, h};
  body.extent = std::max(0.75 * h, std::sqrt(r * r + 0.0625 * h * h));
  return body;
}

ConvexBody convex(const Cylinder& cylinder, const PlacedPrimitive& placed) {
  ConvexBody body;
  body.kind = ConvexBody::Kind::cylinder;
  const double r = placed.scale * cylinder.radius, h = placed.scale * cylinder.half_height;
  body.centre = placed.position;
  body.rotation = placed.rotation;
  body.size = {r, r, h};
  body.extent = std::sqrt(r * r + h * h);
  return body;
}

ConvexBody convex_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  ConvexBody body;
  body.kind = ConvexBody::Kind::triangle;
  body.centre = (a + b + c) / 3;
  body.points = {a, b, c};
  for (const Vec3& p : body.points) body.extent = std::max(body.extent, (p - body.centre).norm());
  return body;
}

namespace {

FaceFeature box_face(const ConvexBody& body, const Vec3& local) {
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(local[i]) > std::abs(local[axis])) axis = i;
  const double side = local[axis] < 0 ? -1 : 1;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  constexpr std::array<double, 4> su{1, -1, -1, 1}, sv{1, 1, -1, -1};
  FaceFeature face;
  face.count = 4;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t from = side > 0 ? k : 3 - k;
    Vec3 p;
    p[axis] = side * body.size[axis];
    p[u] = su[from] * body.size[u];
    p[v] = sv[from] * body.size[v];
    face.points[k] = body.centre + body.rotation * p;
    face.names[k] = static_cast<std::uint8_t>((p.x() > 0 ? 1 : 0) + (p.y() > 0 ? 2 : 0) + (p.z() > 0 ? 4 : 0));
  }
  face.normal = side * body.rotation.col(axis);
  return face;
}

/// A disc as an octagon, its corners on the rim, turned with the body.
FaceFeature disc(const ConvexBody& body, double z, bool up, std::uint8_t first_name) {
  constexpr double h = 0.70710678118654752;
  constexpr std::array<double, 8> c{1, h, 0, -h, -1, -h, 0, h}, s{0, h, 1, h, 0, -h, -1, -h};
  FaceFeature face;
  face.count = 8;
  for (std::size_t k = 0; k < 8; ++k) {
    const std::size_t from = up ? k : 7 - k;
    face.points[k] = body.centre + body.rotation * Vec3(body.size.x() * c[from], body.size.x() * s[from], z);
    face.names[k] = static_cast<std::uint8_t>(first_name + from);
  }
  face.normal = up ? Vec3(body.rotation.col(2)) : Vec3(-body.rotation.col(2));
  return face;
}

FaceFeature segment(const Vec3& a, const Vec3& b) {
  FaceFeature face;
  face.count = 2;
  face.points[0] = a;
  face.points[1] = b;
  face.names = {16, 17};
  return face;
}

}  // namespace

FaceFeature facing(const ConvexBody& body, const Vec3& d) {
  using Kind = ConvexBody::Kind;
  if (body.kind == Kind::triangle) {
    FaceFeature face;
    face.count = 3;
    Vec3 n = (body.points[1] - body.points[0]).cross(body.points[2] - body.points[0]);
    const bool front = n.dot(d) >= 0;
    for (std::size_t k = 0; k < 3; ++k) {
      face.points[k] = body.points[front ? k : 2 - k];
      face.names[k] = static_cast<std::uint8_t>(front ? k : 2 - k);
    }
    const double length = n.norm();
    if (!(length > 0)) return {};
    face.normal = (front ? n : Vec3(-n)) / length;
    return face;
  }
  if (body.kind == Kind::round_cone) {
    // The end balls' farthest points: the whole side where d is square to it.
    const Vec3 n = d.normalized();
    return segment(body.points[0] + (body.radii[0] + body.margin) * n,
                   body.points[1] + (body.radii[1] + body.margin) * n);
  }
  const Vec3 local = body.rotation.transpose() * d;
  if (body.kind == Kind::box) return box_face(body, local);
  if (body.kind != Kind::cylinder && body.kind != Kind::cone) return {};
  const double across = std::sqrt(local.x() * local.x() + local.y() * local.y());
  const Vec3 radial = across > 0 ? Vec3(local.x() / across, local.y() / across, 0) : Vec3(Vec3::UnitX());
  const auto at = [&](double r, double z) { return Vec3(body.centre + body.rotation * (r * radial + Vec3(0, 0, z))); };
  const double r = body.size.x(), h = body.size.z();
  if (body.kind == Kind::cylinder) {
    if (std::abs(local.z()) > across) return disc(body, local.z() < 0 ? -h : h, local.z() >= 0, local.z() < 0 ? 0 : 8);
    return segment(at(r, -h), at(r, h));
  }
  // The base's normal is -z, the side's (h, r) in the half-plane: take the one that d leans to.
  const double side = (h * across + r * local.z()) / std::sqrt(h * h + r * r);
  if (-local.z() > side) return disc(body, -0.25 * h, false, 0);
  return segment(at(r, -0.25 * h), at(0, 0.75 * h));
}

}  // namespace repose::dvi
