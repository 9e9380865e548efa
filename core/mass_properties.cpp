#include "core/mass_properties.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/overloaded.hpp"
#include "core/union_integrals.hpp"

namespace repose {
namespace {

constexpr double pi = std::numbers::pi;

// Volume v, and the mean squares of the coordinates about the centre.
MassProperties from_mean_squares(double v, const Vec3& centre, const Vec3& mean_squares) {
  return {v, centre, inertia_of(v * Mat3(mean_squares.asDiagonal()))};
}

MassProperties of_mesh(const TriMesh& mesh) {
  Vec3 reference = Vec3::Zero();
  for (const Vec3& v : mesh.vertices) reference += v / static_cast<double>(mesh.vertices.size());
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const auto& t : mesh.triangles) {
    // The tetrahedron from the reference point to the triangle, signed.
    const Vec3 a = mesh.vertices[static_cast<std::size_t>(t[0])] - reference,
               b = mesh.vertices[static_cast<std::size_t>(t[1])] - reference,
               c = mesh.vertices[static_cast<std::size_t>(t[2])] - reference, sum = a + b + c;
    const double det = a.dot(b.cross(c));
    volume += det / 6;
    first += det / 24 * sum;
    second += det / 120 * (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  const Vec3 centre = first / volume;
  return {volume, reference + centre, inertia_of(second - volume * centre * centre.transpose())};
}

// Green's theorem in the (r, z) plane: the integral of r^a z^b over the area is that of r^(a+1)/(a+1) z^b dz along the
// outline. Three Gauss points per edge are exact.
MassProperties of_revolved(const Revolved& solid) {
  static constexpr std::array<double, 3> weights{5.0 / 18, 8.0 / 18, 5.0 / 18};
  const std::array<double, 3> nodes{0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)};
  const auto& p = solid.profile;
  double middle = 0;
  for (const Vec2& q : p) middle += q.y() / static_cast<double>(p.size());
  double r1 = 0, r1z = 0, r1zz = 0, r3 = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec2 a = p[i], edge = p[(i + 1) % p.size()] - a;
    for (std::size_t k = 0; k < 3; ++k) {
      const double r = a.x() + nodes[k] * edge.x(), z = a.y() + nodes[k] * edge.y() - middle;
      const double dz = weights[k] * edge.y(), half = 0.5 * r * r * dz;
      r1 += half;
      r1z += half * z;
      r1zz += half * z * z;
      r3 += 0.5 * r * r * half;
    }
  }
  const double centre = r1z / r1, across = pi * r3;  // integral of x^2, and of y^2
  const Vec3 second(across, across, 2 * pi * (r1zz - r1z * centre));
  return {2 * pi * r1, Vec3(0, 0, middle + centre), inertia_of(second.asDiagonal())};
}

// True if a plane parts the two: along the frame's axes, the line of centres, or either part's own axes.
bool surely_disjoint(const Part& a, const Part& b) {
  const auto parts_along = [&](const Vec3& d) {
    return support(a, d) <= -support(b, -d) || support(b, d) <= -support(a, -d);
  };
  const Vec3 line = b.pose.position - a.pose.position;
  if (line.norm() > 0 && parts_along(line.normalized())) return true;
  for (int i = 0; i < 3; ++i)
    if (parts_along(Vec3::Unit(i)) || parts_along(a.pose.orientation * Vec3::Unit(i)) ||
        parts_along(b.pose.orientation * Vec3::Unit(i)))
      return true;
  return false;
}

MassProperties placed(const MassProperties& m, const Pose& pose) {
  const Mat3 turn = pose.orientation.toRotationMatrix();
  return {m.volume, pose.to_world(m.centre), turn * m.inertia * turn.transpose()};
}

MassProperties sum(const std::vector<MassProperties>& bodies) {
  if (bodies.size() == 1) return bodies[0];
  MassProperties total;
  for (const MassProperties& m : bodies) {
    total.volume += m.volume;
    total.centre += m.volume * m.centre;
  }
  total.centre /= total.volume;
  for (const MassProperties& m : bodies) {
    const Vec3 arm = m.centre - total.centre;
    total.inertia += m.inertia + m.volume * inertia_of(arm * arm.transpose());
  }
  return total;
}

}  // namespace

MassProperties mass_properties(const Primitive& primitive) {
  return std::visit(
      Overloaded{
          [](const Sphere& s) {
            const double r2 = s.radius * s.radius;
            return from_mean_squares(4 * pi / 3 * s.radius * r2, Vec3::Zero(), Vec3::Constant(r2 / 5));
          },
          [](const Ellipsoid& e) {
            return from_mean_squares(4 * pi / 3 * e.semi_axes.prod(), Vec3::Zero(), e.semi_axes.cwiseAbs2() / 5);
          },
          [](const RoundCone& c) {
            const Part part{c, {}};
            return *coaxial_union({&part, 1});
          },
          [](const Cone& c) {
            const double r2 = c.radius * c.radius, h2 = c.height * c.height;
            return from_mean_squares(pi / 3 * r2 * c.height, Vec3(0, 0, c.height / 4),
                                     Vec3(3 * r2 / 20, 3 * r2 / 20, 3 * h2 / 80));
          },
          [](const Box& b) {
            return from_mean_squares(8 * b.half_extents.prod(), Vec3::Zero(), b.half_extents.cwiseAbs2() / 3);
          },
          [](const Cylinder& c) {
            const double r2 = c.radius * c.radius, h2 = c.half_height * c.half_height;
            return from_mean_squares(2 * pi * r2 * c.half_height, Vec3::Zero(), Vec3(r2 / 4, r2 / 4, h2 / 3));
          },
          [](const HalfSpace&) -> MassProperties {
            throw Error("", "a half-space has no finite mass", "use it for a fixed body only");
          },
          [](const Revolved& r) { return of_revolved(r); },
          [](const TriMesh& m) { return of_mesh(m); },
      },
      primitive);
}

double support(const Part& part, const Vec3& direction) {
  const Vec3 d = part.pose.orientation.conjugate() * direction;
  const double across = std::hypot(d.x(), d.y());
  const double local = std::visit(
      Overloaded{
          [&](const Sphere& s) { return s.radius * d.norm(); },
          [&](const Ellipsoid& e) { return e.semi_axes.cwiseProduct(d).norm(); },
          [&](const RoundCone& c) { return std::max(c.radius_a * d.norm(), c.length * d.x() + c.radius_b * d.norm()); },
          [&](const Cone& c) { return std::max(c.radius * across, c.height * d.z()); },
          [&](const Box& b) { return b.half_extents.dot(d.cwiseAbs()); },
          [&](const Cylinder& c) { return c.radius * across + c.half_height * std::abs(d.z()); },
          [](const HalfSpace&) { return std::numeric_limits<double>::infinity(); },
          [&](const Revolved& r) {
            double most = -std::numeric_limits<double>::infinity();
            for (const Vec2& p : r.profile) most = std::max(most, p.x() * across + p.y() * d.z());
            return most;
          },
          [&](const TriMesh& m) {
            double most = -std::numeric_limits<double>::infinity();
            for (const Vec3& v : m.vertices) most = std::max(most, v.dot(d));
            return most;
          },
      },
      part.primitive);
  return local + direction.dot(part.pose.position);
}

MassProperties union_mass_properties(std::span<const Part> parts) {
  // Clusters of parts that may overlap: `cluster[i]` is the least index that part i is joined with.
  std::vector<std::size_t> cluster(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    cluster[i] = i;
    for (std::size_t j = 0; j < i; ++j) {
      if (cluster[j] == cluster[i] || surely_disjoint(parts[i], parts[j])) continue;
      const std::size_t from = std::max(cluster[i], cluster[j]), to = std::min(cluster[i], cluster[j]);
      for (std::size_t k = 0; k <= i; ++k)
        if (cluster[k] == from) cluster[k] = to;
    }
  }
  std::vector<MassProperties> bodies;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::vector<Part> members;
    for (std::size_t j = i; j < parts.size(); ++j)
      if (cluster[j] == i) members.push_back(parts[j]);
    if (members.size() == 1) {
      bodies.push_back(placed(mass_properties(members[0].primitive), members[0].pose));
    } else if (members.size() > 1) {
      const auto exact = coaxial_union(members);
      bodies.push_back(exact ? *exact : ray_union(members));
    }
  }
  return sum(bodies);
}

Principal principal_axes(const Mat3& inertia) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(0.5 * (inertia + inertia.transpose()));
  const Vec3 moments = eigen.eigenvalues();
  // Where two moments agree to this, rounding alone would choose the axes.
  const double close = 1e-9 * moments[2];
  const bool lower_pair = moments[1] - moments[0] <= close, upper_pair = moments[2] - moments[1] <= close;
  if (lower_pair && upper_pair) return {moments, Quat::Identity()};

  const auto upright = [&](int i) {
    Vec3 axis = eigen.eigenvectors().col(i);
    int largest;
    axis.cwiseAbs().maxCoeff(&largest);
    return Vec3(axis[largest] > 0 ? axis : Vec3(-axis));
  };
  Mat3 axes;
  if (lower_pair || upper_pair) {
    const Vec3 single = upright(upper_pair ? 0 : 2);
    int nearest;
    single.maxCoeff(&nearest);
    const Vec3 given = Vec3::Unit((nearest + 1) % 3);
    const Vec3 first = (given - given.dot(single) * single).normalized();
    if (upper_pair)
      axes << single, first, single.cross(first);
    else
      axes << first, single.cross(first), single;
  } else {
    const Vec3 first = upright(0), second = upright(1);
    axes << first, second, first.cross(second);
  }
  return {moments, Quat(axes).normalized()};
}

}  // namespace repose
