#pragma once
/// Closed triangle meshes. The cost is linear in the number of triangles: meshes are for small parts.
#include "backends/dvi/collide_support.hpp"

namespace repose::dvi {

struct PlacedMesh {
  const TriMesh& mesh;
  Vec3 position;
  Mat3 rotation;
  double scale = 1;

  Vec3 to_local(const Vec3& world) const { return rotation.transpose() * (world - position) / scale; }
  Vec3 to_world(const Vec3& local) const { return position + rotation * (scale * local); }
};

/// Signed distance of a point from the surface, negative inside.
PointDistance point_distance(const PlacedMesh& b, const Vec3& point);

/// One contact per face, edge or vertex whose distance from the centre is a local minimum (faces that meet in a flat
/// edge count once). A centre inside gets the nearest feature alone; the side is told by angle-weighted normals
/// (Baerentzen & Aanaes 2005).
void collide_sphere_mesh(const PlacedSphere& a, const PlacedMesh& b, const ContactSink& sink,
                         std::uint32_t feature_offset = 0, std::uint32_t feature_stride = 1);

/// Every triangle in reach through the general convex routine; contacts on edges and corners only where no neighbouring
/// triangle rises above the contact plane. A body whose centre has passed a triangle is no longer held by it.
void collide_convex_mesh(const ConvexBody& a, const PlacedMesh& b, const ContactSink& sink);

/// Vertices of each against the other, and edge against edge.
void collide_meshes(const PlacedMesh& a, const PlacedMesh& b, const ContactSink& sink);

}  // namespace repose::dvi
