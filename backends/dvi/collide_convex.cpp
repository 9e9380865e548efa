#include "backends/dvi/collide_convex.hpp"

#include "backends/dvi/collide_gjk.hpp"

namespace repose::dvi {

ConvexGap convex_gap(const ConvexBody& a, const ConvexBody& b, double margin) {
  const Difference difference{a, b};
  const double margins = a.margin + b.margin;
  ConvexGap result;
  const CoreDistance apart = core_distance(difference, margin + margins);
  if (apart.state == CoreDistance::State::beyond) {
    result.beyond = true;
    return result;
  }
  DifferencePoint nearest;
  if (apart.state == CoreDistance::State::apart) {
    nearest = apart.nearest;
    result.normal = -nearest.w / apart.distance;
    result.gap = apart.distance - margins;
  } else {
    const CoreDepth inside = core_depth(difference);
    nearest = inside.nearest;
    result.normal = inside.normal;
    result.gap = -inside.depth - margins;
  }
  result.on_a = a.centre + nearest.on_a + a.margin * result.normal;
  result.on_b = a.centre + nearest.on_b - b.margin * result.normal;
  return result;
}

namespace {

constexpr std::size_t capacity = 16;

/// A corner of the clipped feature: where it came from names it.
struct Corner {
  Vec3 point;
  std::uint32_t name;
};

struct Polygon {
  std::array<Corner, capacity> corners;
  std::size_t count = 0;
  void push(const Vec3& point, std::uint32_t name) {
    if (count < capacity) corners[count++] = {point, name};
  }
};

/// Keeps the part of the polygon (or segment) on the inner side of the plane; `edge` names the plane.
Polygon clip(const Polygon& in, const Vec3& on_plane, const Vec3& outward, std::uint32_t edge) {
  Polygon out;
  const std::size_t sides = in.count == 2 ? 1 : in.count;
  const auto height = [&](const Corner& c) { return outward.dot(c.point - on_plane); };
  for (std::size_t k = 0; k < sides; ++k) {
    const Corner &a = in.corners[k], &b = in.corners[(k + 1) % in.count];
    const double ha = height(a), hb = height(b);
    if (ha <= 0) out.push(a.point, a.name);
    if ((ha < 0 && hb > 0) || (ha > 0 && hb < 0)) {
      const Corner& cut = ha > 0 ? a : b;
      out.push(a.point + (ha / (ha - hb)) * (b.point - a.point), 0x8000u | (edge << 10) | (cut.name & 0x3ffu));
    }
    if (in.count == 2 && hb <= 0) out.push(b.point, b.name);
  }
  return out;
}

struct Manifold {
  std::array<ContactPoint, capacity> points;
  std::size_t count = 0;
};

/// The four points that span the most: the deepest, the farthest from it, and the farthest on either side of that line.
void reduce_to_four(Manifold& m, const Vec3& normal) {
  if (m.count <= 4) return;
  std::array<std::size_t, 4> keep{};
  for (std::size_t k = 1; k < m.count; ++k)
    if (m.points[k].gap < m.points[keep[0]].gap) keep[0] = k;
  const Vec3 first = m.points[keep[0]].point;
  keep[1] = keep[0];
  for (std::size_t k = 0; k < m.count; ++k)
    if ((m.points[k].point - first).squaredNorm() > (m.points[keep[1]].point - first).squaredNorm()) keep[1] = k;
  const Vec3 across = normal.cross(m.points[keep[1]].point - first);
  keep[2] = keep[3] = keep[0];
  double most = 0, least = 0;
  for (std::size_t k = 0; k < m.count; ++k) {
    const double side = across.dot(m.points[k].point - first);
    if (side > most) {
      most = side;
      keep[2] = k;
    }
    if (side < least) {
      least = side;
      keep[3] = k;
    }
  }
  std::sort(keep.begin(), keep.end());
  const auto end = std::unique(keep.begin(), keep.end());
  std::size_t count = 0;
  for (auto k = keep.begin(); k != end; ++k) m.points[count++] = m.points[*k];
  m.count = count;
}

/// Points where `incident` (of one body) lies over the polygon `reference` (of the other), seen along the normal.
void face_manifold(const FaceFeature& reference, const FaceFeature& incident, bool reference_is_a, const Vec3& normal,
                   double margin, Manifold& out) {
  Polygon polygon;
  for (std::size_t k = 0; k < static_cast<std::size_t>(incident.count); ++k)
    polygon.push(incident.points[k], incident.names[k]);
  const std::size_t sides = static_cast<std::size_t>(reference.count);
  for (std::size_t k = 0; k < sides && polygon.count > 0; ++k) {
    const Vec3 &p = reference.points[k], &q = reference.points[(k + 1) % sides];
    // The sides run along the contact normal, which may lean against the face.
    Vec3 outward = (q - p).cross(normal);
    if (outward.dot((q - p).cross(reference.normal)) < 0) outward = -outward;
    polygon = clip(polygon, p, outward, reference.names[k]);
  }
  const double lean = reference.normal.dot(normal);
  for (std::size_t k = 0; k < polygon.count; ++k) {
    const Corner& c = polygon.corners[k];
    const double above = reference.normal.dot(c.point - reference.points[0]) / lean;  // along the normal a to b
    const double gap = reference_is_a ? above : -above;
    if (!(gap <= margin)) continue;
    ContactPoint& point = out.points[out.count++];
    point.normal = normal;
    point.gap = gap;
    point.point = c.point - 0.5 * above * normal;
    point.feature = 1 + c.name + (reference_is_a ? 0x10000u : 0u);
  }
}

/// Two edges, nearly parallel: the ends of the stretch they share.
void edge_manifold(const FaceFeature& a, const FaceFeature& b, const Vec3& normal, double margin, Manifold& out) {
  const Vec3 ua = a.points[1] - a.points[0], ub = b.points[1] - b.points[0];
  if (ua.cross(ub).squaredNorm() > 1e-4 * ua.squaredNorm() * ub.squaredNorm()) return;
  Polygon stretch;
  for (std::size_t k = 0; k < 2; ++k) stretch.push(b.points[k], b.names[k]);
  stretch = clip(stretch, a.points[0], -ua, 0);
  if (stretch.count == 2) stretch = clip(stretch, a.points[1], ua, 1);
  for (std::size_t k = 0; stretch.count == 2 && k < 2; ++k) {
    const Corner& c = stretch.corners[k];
    const Vec3 foot = a.points[0] + (ua.dot(c.point - a.points[0]) / ua.squaredNorm()) * ua;
    const double gap = normal.dot(c.point - foot);
    if (!(gap <= margin)) continue;
    ContactPoint& point = out.points[out.count++];
    point.normal = normal;
    point.gap = gap;
    point.point = 0.5 * (c.point + foot);
    point.feature = 0x20001u + c.name;
  }
}

}  // namespace

void add_contacts(const ConvexBody& a, const ConvexBody& b, const ConvexGap& found, const ContactSink& sink,
                  std::uint32_t feature_offset) {
  const Vec3& n = found.normal;
  const FaceFeature on_a = facing(a, n), on_b = facing(b, -n);
  Manifold manifold;
  // A face serves as reference only while the normal leans towards it.
  const double lean_a = on_a.count > 2 ? on_a.normal.dot(n) : 0, lean_b = on_b.count > 2 ? -on_b.normal.dot(n) : 0;
  if (std::max(lean_a, lean_b) > 0.7 && on_a.count > 0 && on_b.count > 0) {
    // Prefer a by a little, so that parallel faces do not swap roles from step to step.
    if (lean_a >= lean_b - 1e-3)
      face_manifold(on_a, on_b, true, n, sink.margin, manifold);
    else
      face_manifold(on_b, on_a, false, n, sink.margin, manifold);
  } else if (on_a.count == 2 && on_b.count == 2) {
    edge_manifold(on_a, on_b, n, sink.margin, manifold);
  }
  reduce_to_four(manifold, n);
  bool covered = false;
  const double size = a.extent + b.extent;
  for (std::size_t k = 0; k < manifold.count; ++k) {
    const ContactPoint& p = manifold.points[k];
    covered = covered || p.gap <= found.gap + 1e-8 * size;
    sink.add(p.point, p.normal, p.gap, feature_offset + p.feature);
  }
  if (!covered) sink.add(0.5 * (found.on_a + found.on_b), n, found.gap, feature_offset);
}

void collide_convex(const ConvexBody& a, const ConvexBody& b, const ContactSink& sink) {
  const double reach = a.extent + b.extent + sink.margin;
  if ((a.centre - b.centre).squaredNorm() > reach * reach) return;
  const ConvexGap found = convex_gap(a, b, sink.margin);
  if (!found.beyond && found.gap <= sink.margin) add_contacts(a, b, found, sink, 0);
}

}  // namespace repose::dvi
