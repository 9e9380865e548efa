#include "backends/dvi/collide_mesh.hpp"

#include "backends/dvi/collide_convex.hpp"
#include "backends/dvi/collide_mesh_view.hpp"

namespace repose::dvi {

namespace {

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
    sink.add(a.centre - (a.radius + 0.5 * gap) * world, -world, gap,
             feature_offset + feature_stride * name_of(t, q.region));
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

void collide_convex_mesh(const ConvexBody& a, const PlacedMesh& b, const ContactSink& sink) {
  const MeshView mesh(b.mesh);
  const Vec3 centre = b.to_local(a.centre);
  const double reach = (a.extent + sink.margin) / b.scale;
  const MeshNearest nearest = nearest_on_mesh(mesh, centre);
  // The plane through the surface point nearest to the centre, as the last resort in deep overlap.
  const auto add_plane = [&](const Vec3& local_outward) {
    const Vec3 outward = b.rotation * local_outward;
    const double height = outward.dot(a.centre - b.to_world(nearest.nearest.point));
    const double gap = height - a.reach(-outward, a.centre);
    const Vec3 deepest = a.support(-outward) - a.margin * outward;
    sink.add(deepest - 0.5 * gap * outward, -outward, gap, name_of(nearest.triangle, nearest.nearest.region));
  };
  if (nearest.inside) {
    add_plane(nearest.outward);
    return;
  }
  if (nearest.nearest.distance2 > reach * reach) return;
  const std::size_t first = sink.out->size();
  bool pierced = false;
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
      if (found.beyond || !(found.gap <= sink.margin)) continue;
      pierced = pierced || found.gap < 0;
      if (!(found.normal.dot(up) < 0)) continue;
      if (found.normal.dot(up) > -1 + 1e-12 && neighbour_rises(b, mesh, t, found.on_b, -found.normal, a.extent))
        continue;
    }
    add_contacts(a, triangle, found, sink, static_cast<std::uint32_t>(t) << 18);
  }
  if (pierced && sink.out->size() == first) add_plane((centre - nearest.nearest.point).normalized());
  // Triangles that share an edge find the same points along it.
  merge_repeated(*sink.out, first, 1e-6 * a.extent);
}

}  // namespace repose::dvi
