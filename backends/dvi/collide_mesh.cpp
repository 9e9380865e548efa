#include "backends/dvi/collide_mesh.hpp"

#include "backends/dvi/collide_convex.hpp"

namespace repose::dvi {

namespace {

/// Nearest point of a triangle. `region`: 0 the face, 1 + k the edge k to k + 1, 4 + k the corner k.
struct TrianglePoint {
  Vec3 point = Vec3::Zero();
  int region = 0;
  double distance2 = std::numeric_limits<double>::infinity();
};

using Corners = std::array<Vec3, 3>;

/// Voronoi regions of the triangle, after Ericson, Real-Time Collision Detection, 5.1.5.
TrianglePoint nearest_on_triangle(const Corners& t, const Vec3& p) {
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
  static bool has(const std::array<int, 3>& t, int vertex) { return t[0] == vertex || t[1] == vertex || t[2] == vertex; }

  /// Outward direction at the feature that `region` of triangle t names: sum of the normals of the triangles that share it,
  /// at a corner weighted by their angles.
  Vec3 feature_normal(int t, int region) const {
    if (region == 0) return normal(t);
    const auto& own = index(t);
    const int i = own[static_cast<std::size_t>((region - 1) % 3)], j = region < 4 ? own[static_cast<std::size_t>(region % 3)] : i;
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

  /// Whether every triangle that shares the feature has its nearest point to p there: then it is a local minimum. True for
  /// one triangle per feature only, that of the lowest number.
  bool is_local_minimum(int t, int region, const Vec3& p) const {
    if (region == 0) return true;
    const auto& own = index(t);
    const int i = own[static_cast<std::size_t>((region - 1) % 3)], j = region < 4 ? own[static_cast<std::size_t>(region % 3)] : i;
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

MeshNearest nearest_on_mesh(const MeshView& mesh, const Vec3& p) {
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

std::uint32_t name_of(int triangle, int region) {
  return 8 * static_cast<std::uint32_t>(triangle) + static_cast<std::uint32_t>(region);
}

}  // namespace

PointDistance point_distance(const PlacedMesh& b, const Vec3& point) {
  const Vec3 local = b.to_local(point);
  const MeshNearest nearest = nearest_on_mesh(MeshView(b.mesh), local);
  const double distance = std::sqrt(nearest.nearest.distance2), sign = nearest.inside ? -1 : 1;
  const Vec3 n = distance > 0 ? Vec3(sign * (local - nearest.nearest.point) / distance) : nearest.outward;
  return {sign * b.scale * distance, b.rotation * n};
}

void collide_sphere_mesh(const PlacedSphere& a, const PlacedMesh& b, const ContactSink& sink,
                         std::uint32_t feature_offset, std::uint32_t feature_stride) {
  const MeshView mesh(b.mesh);
  const Vec3 centre = b.to_local(a.centre);
  const double radius = a.radius / b.scale, reach = radius + sink.margin / b.scale;
  const MeshNearest nearest = nearest_on_mesh(mesh, centre);
  if (!nearest.inside && nearest.nearest.distance2 > reach * reach) return;
  const auto add = [&](int t, const TrianglePoint& q, const Vec3& outward, double sign) {
    const double distance = std::sqrt(q.distance2);
    const Vec3 n = distance > 0 ? Vec3(sign * (centre - q.point) / distance) : outward;
    const Vec3 world = b.rotation * n;
    const double gap = b.scale * (sign * distance - radius);
    sink.add(a.centre - (a.radius + 0.5 * gap) * world, -world, gap, feature_offset + feature_stride * name_of(t, q.region));
  };
  if (nearest.inside) {
    add(nearest.triangle, nearest.nearest, nearest.outward, -1);
    return;
  }
  bool any = false;
  for (int t = 0; t < mesh.size(); ++t) {
    const Corners corners = mesh.corners(t);
    const TrianglePoint q = nearest_on_triangle(corners, centre);
    if (q.distance2 > reach * reach || !mesh.is_local_minimum(t, q.region, centre)) continue;
    const Vec3 outward = mesh.feature_normal(t, q.region);
    if (outward.dot(centre - q.point) < 0) continue;
    add(t, q, outward, 1);
    any = true;
  }
  // Rounding may let two neighbours each leave the point on their common edge to the other.
  if (!any) add(nearest.triangle, nearest.nearest, nearest.outward, 1);
}

namespace {

/// Whether a triangle beside the witness point `w` rises above the plane through it with normal `up`: then w is no local
/// minimum of the distance.
bool neighbour_rises(const PlacedMesh& b, const MeshView& mesh, int triangle, const Vec3& w, const Vec3& up, double size) {
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

}  // namespace

void collide_convex_mesh(const ConvexBody& a, const PlacedMesh& b, const ContactSink& sink) {
  const MeshView mesh(b.mesh);
  const Vec3 centre = b.to_local(a.centre);
  const double reach = (a.extent + sink.margin) / b.scale;
  const MeshNearest nearest = nearest_on_mesh(mesh, centre);
  if (nearest.inside) {
    const Vec3 outward = b.rotation * nearest.outward;
    const double gap = -b.scale * std::sqrt(nearest.nearest.distance2) - a.reach(-outward, a.centre);
    const Vec3 deepest = a.support(-outward) - a.margin * outward;
    sink.add(deepest - 0.5 * gap * outward, -outward, gap, name_of(nearest.triangle, nearest.nearest.region));
    return;
  }
  if (nearest.nearest.distance2 > reach * reach) return;
  const std::size_t first = sink.out->size();
  for (int t = 0; t < mesh.size(); ++t) {
    const Corners local = mesh.corners(t);
    const Vec3 local_normal = mesh.normal(t);
    const double height = local_normal.dot(centre - local[0]);
    if (height < 0 || height > reach || nearest_on_triangle(local, centre).distance2 > reach * reach) continue;
    const Vec3 up = b.rotation * local_normal;
    const ConvexBody triangle = convex_triangle(b.to_world(local[0]), b.to_world(local[1]), b.to_world(local[2]));
    const Vec3 lowest = a.support(-up) - a.margin * up;
    const double over = up.dot(lowest - triangle.points[0]);
    if (over > sink.margin) continue;
    ConvexGap found;
    if (nearest_on_triangle(local, b.to_local(lowest)).region == 0) {
      found = {-up, over, lowest, lowest - over * up, false};
    } else {
      found = convex_gap(a, triangle, sink.margin);
      if (found.beyond || !(found.gap <= sink.margin) || !(found.normal.dot(up) < 0)) continue;
      if (found.normal.dot(up) > -1 + 1e-12 && neighbour_rises(b, mesh, t, found.on_b, -found.normal, a.extent)) continue;
    }
    add_contacts(a, triangle, found, sink, static_cast<std::uint32_t>(t) << 18);
  }
  // Triangles that share an edge find the same points along it.
  merge_repeated(*sink.out, first, 1e-6 * a.extent);
}

void collide_meshes(const PlacedMesh& a, const PlacedMesh& b, const ContactSink& sink) {
  const auto vertices_against = [](const PlacedMesh& from, const PlacedMesh& to, const ContactSink& target,
                                   std::uint32_t offset) {
    Vec3 lower = to.mesh.vertices.front(), upper = lower;
    for (const Vec3& v : to.mesh.vertices) {
      lower = lower.cwiseMin(v);
      upper = upper.cwiseMax(v);
    }
    const double margin = target.margin / to.scale;
    std::uint32_t name = offset;
    for (const Vec3& v : from.mesh.vertices) {
      const Vec3 world = from.to_world(v), local = to.to_local(world);
      if (((local - lower).array() >= -margin).all() && ((local - upper).array() <= margin).all())
        collide_sphere_mesh({world, 0}, to, target, name, 1u << 20);
      name += 2;
    }
  };
  vertices_against(a, b, sink, 0);
  ContactSink turned = sink;
  turned.swapped = !sink.swapped;
  vertices_against(b, a, turned, 1);
}

}  // namespace repose::dvi
