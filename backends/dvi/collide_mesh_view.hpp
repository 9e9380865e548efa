#pragma once
/// A triangle mesh in its own frame: nearest points, and what the neighbours of a feature say. No adjacency is stored:
/// every question walks over the triangles.
#include "backends/dvi/collide_mesh.hpp"

namespace repose::dvi {

/// Nearest point of a triangle. `region`: 0 the face, 1 + k the edge k to k + 1, 4 + k the corner k.
struct TrianglePoint {
  Vec3 point = Vec3::Zero();
  int region = 0;
  double distance2 = std::numeric_limits<double>::infinity();
};

using Corners = std::array<Vec3, 3>;

/// Voronoi regions of the triangle, after Ericson, Real-Time Collision Detection, 5.1.5.
inline TrianglePoint nearest_on_triangle(const Corners& t, const Vec3& p) {
  const auto found = [&](const Vec3& q, int region) { return TrianglePoint{q, region, (p - q).squaredNorm()}; };
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0];
  const Vec3 ap = p - t[0], bp = p - t[1], cp = p - t[2];
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return found(t[0], 4);
  if (d3 >= 0 && d4 <= d3) return found(t[1], 5);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return found(t[0] + (d1 / (d1 - d3)) * ab, 1);
  if (d6 >= 0 && d5 <= d6) return found(t[2], 6);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return found(t[0] + (d2 / (d2 - d6)) * ac, 3);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return found(t[1] + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (t[2] - t[1]), 2);
  const double sum = va + vb + vc;
  return found(t[0] + (vb / sum) * ab + (vc / sum) * ac, 0);
}

/// A mesh in its own frame and unit.
class MeshView {
 public:
  explicit MeshView(const TriMesh& mesh) : mesh_(mesh) {}

  int size() const { return static_cast<int>(mesh_.triangles.size()); }
  const std::array<int, 3>& index(int t) const { return mesh_.triangles[static_cast<std::size_t>(t)]; }
  Corners corners(int t) const {
    const auto& i = index(t);
    return {at(i[0]), at(i[1]), at(i[2])};
  }
  Vec3 normal(int t) const {
    const Corners c = corners(t);
    return (c[1] - c[0]).cross(c[2] - c[0]).normalized();
  }
  static bool has(const std::array<int, 3>& t, int vertex) {
    return t[0] == vertex || t[1] == vertex || t[2] == vertex;
  }

  /// Outward direction at the feature that `region` of triangle t names: sum of the normals of the triangles that share
  /// it, at a corner weighted by their angles.
  Vec3 feature_normal(int t, int region) const {
    if (region == 0) return normal(t);
    const auto& own = index(t);
    const int i = own[static_cast<std::size_t>((region - 1) % 3)],
              j = region < 4 ? own[static_cast<std::size_t>(region % 3)] : i;
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < size(); ++k) {
      const auto& other = index(k);
      if (!has(other, i) || !has(other, j)) continue;
      double weight = 1;
      if (i == j) {
        const std::size_t at_i = other[0] == i ? 0 : other[1] == i ? 1 : 2;
        const Corners c = corners(k);
        const Vec3 u = c[(at_i + 1) % 3] - c[at_i], v = c[(at_i + 2) % 3] - c[at_i];
        weight = std::atan2(u.cross(v).norm(), u.dot(v));
      }
      sum += weight * normal(k);
    }
    return sum.normalized();
  }

  /// Whether every triangle that shares the feature has its nearest point to p there: then it is a local minimum. True
  /// for one triangle per feature only, that of the lowest number.
  bool is_local_minimum(int t, int region, const Vec3& p) const {
    if (region == 0) return true;
    const auto& own = index(t);
    const int i = own[static_cast<std::size_t>((region - 1) % 3)],
              j = region < 4 ? own[static_cast<std::size_t>(region % 3)] : i;
    for (int k = 0; k < size(); ++k) {
      const auto& other = index(k);
      if (k == t || !has(other, i) || !has(other, j)) continue;
      if (k < t) return false;
      const int there = nearest_on_triangle(corners(k), p).region;
      if (there == 0) return false;
      const std::size_t first = static_cast<std::size_t>((there - 1) % 3);
      const int m = other[first], n = there < 4 ? other[(first + 1) % 3] : m;
      if (!((m == i && n == j) || (m == j && n == i))) return false;
    }
    return true;
  }

 private:
  const Vec3& at(int vertex) const { return mesh_.vertices[static_cast<std::size_t>(vertex)]; }
  const TriMesh& mesh_;
};

struct MeshNearest {
  int triangle = -1;
  TrianglePoint nearest;
  Vec3 outward = Vec3::UnitZ();  ///< of the feature
  bool inside = false;
};

inline MeshNearest nearest_on_mesh(const MeshView& mesh, const Vec3& p) {
  MeshNearest best;
  for (int t = 0; t < mesh.size(); ++t) {
    const TrianglePoint q = nearest_on_triangle(mesh.corners(t), p);
    if (q.distance2 < best.nearest.distance2) {
      best.nearest = q;
      best.triangle = t;
    }
  }
  best.outward = mesh.feature_normal(best.triangle, best.nearest.region);
  best.inside = best.outward.dot(p - best.nearest.point) < 0;
  return best;
}

/// Whether a triangle beside the witness point `w` rises above the plane through it with normal `up`: then w is no
/// local minimum of the distance.
inline bool neighbour_rises(const PlacedMesh& b, const MeshView& mesh, int triangle, const Vec3& w, const Vec3& up,
                            double size) {
  const Vec3 own = b.to_local(w), own_up = b.rotation.transpose() * up;
  const double slack = 1e-7 * size / b.scale;
  for (int t = 0; t < mesh.size(); ++t) {
    if (t == triangle) continue;
    const Corners c = mesh.corners(t);
    const double top = std::max({own_up.dot(c[0] - own), own_up.dot(c[1] - own), own_up.dot(c[2] - own)});
    if (top > 100 * slack && nearest_on_triangle(c, own).distance2 < slack * slack) return true;
  }
  return false;
}

}  // namespace repose::dvi
