#include "backends/dvi/collide_mesh_view.hpp"

namespace repose::dvi {

namespace {

struct Edge {
  Vec3 from, along;
  std::uint32_t name;
};

/// Each edge of a closed surface occurs once in either direction.
template <class F>
void for_each_edge(const PlacedMesh& m, const F& f) {
  std::uint32_t name = 0;
  for (const auto& t : m.mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k, ++name) {
      const int i = t[k], j = t[(k + 1) % 3];
      if (i > j) continue;
      const Vec3 from = m.to_world(m.mesh.vertices[static_cast<std::size_t>(i)]);
      f(Edge{from, m.to_world(m.mesh.vertices[static_cast<std::size_t>(j)]) - from, name});
    }
}

/// Two edges that cross: a contact if neither surface rises above the plane between them. Apart, the normal points from
/// edge to edge; overlapped, the other way.
void collide_edges(const PlacedMesh& a, const Edge& ea, const PlacedMesh& b, const Edge& eb, double size,
                   const ContactSink& sink) {
  const Vec3 &u = ea.along, &v = eb.along, w = ea.from - eb.from;
  const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm(), det = uu * vv - uv * uv;
  if (!(det > 1e-12 * uu * vv)) return;
  const double s = (uv * v.dot(w) - vv * u.dot(w)) / det, t = (uu * v.dot(w) - uv * u.dot(w)) / det;
  if (!(s > 0 && s < 1 && t > 0 && t < 1)) return;
  const Vec3 on_a = ea.from + s * u, on_b = eb.from + t * v;
  const Vec3 cross = u.cross(v).normalized();
  const double height = cross.dot(on_b - on_a);
  if (std::abs(height) > std::max(sink.margin, std::sqrt(std::min(uu, vv)))) return;
  const MeshView view_a(a.mesh), view_b(b.mesh);
  for (const double side : {1.0, -1.0}) {
    const Vec3 n = side * cross;
    const double gap = side * height;
    if (!(gap <= sink.margin)) continue;
    if (neighbour_rises(a, view_a, -1, on_a, n, size) || neighbour_rises(b, view_b, -1, on_b, -n, size)) continue;
    sink.add(0.5 * (on_a + on_b), n, gap, 0x80000000u + ea.name * 65599u + eb.name);
  }
}

}  // namespace

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
  const std::size_t first = sink.out->size();
  vertices_against(a, b, sink, 0);
  ContactSink turned = sink;
  turned.swapped = !sink.swapped;
  vertices_against(b, a, turned, 1);
  double size = 0;
  for (const PlacedMesh* m : {&a, &b})
    for (const Vec3& v : m->mesh.vertices) size = std::max(size, m->scale * v.norm());
  for_each_edge(
      a, [&](const Edge& ea) { for_each_edge(b, [&](const Edge& eb) { collide_edges(a, ea, b, eb, size, sink); }); });
  merge_repeated(*sink.out, first, 1e-6 * size);
}

}  // namespace repose::dvi
