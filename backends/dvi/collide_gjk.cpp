#include "backends/dvi/collide_gjk.hpp"

namespace repose::dvi {

namespace {

/// Up to four points of the difference and the weights of the point of their hull that is nearest to the origin.
struct Simplex {
  std::array<DifferencePoint, 4> points;
  std::array<double, 4> weights{};
  int count = 0;

  DifferencePoint nearest() const {
    DifferencePoint p;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      p.w += weights[k] * points[k].w;
      p.on_a += weights[k] * points[k].on_a;
      p.on_b += weights[k] * points[k].on_b;
    }
    return p;
  }
};

struct Weights {
  std::array<double, 4> w{};
  double distance2 = std::numeric_limits<double>::infinity();
};

Weights on_segment(const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0 ? std::clamp(-a.dot(ab) / length2, 0.0, 1.0) : 0.0;
  return {{1 - t, t, 0, 0}, (a + t * ab).squaredNorm()};
}

Weights on_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double n2 = n.squaredNorm();
  const double scale = std::max((b - a).squaredNorm(), (c - a).squaredNorm());
  if (n2 > 1e-24 * scale * scale) {
    const double wa = n.dot(b.cross(c)), wb = n.dot(c.cross(a)), wc = n.dot(a.cross(b));
    if (wa >= 0 && wb >= 0 && wc >= 0) {
      const double sum = wa + wb + wc, height = n.dot(a);
      return {{wa / sum, wb / sum, wc / sum, 0}, height * height / n2};
    }
  }
  Weights best = on_segment(a, b);
  const Weights bc = on_segment(b, c), ca = on_segment(c, a);
  if (bc.distance2 < best.distance2) best = {{0, bc.w[0], bc.w[1], 0}, bc.distance2};
  if (ca.distance2 < best.distance2) best = {{ca.w[1], 0, ca.w[0], 0}, ca.distance2};
  return best;
}

/// Distance 0 with no weights if the origin is inside.
Weights on_tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double volume = (b - a).cross(c - a).dot(d - a);
  const double scale = std::max({(b - a).norm(), (c - a).norm(), (d - a).norm()});
  const bool flat = !(std::abs(volume) > 1e-14 * scale * scale * scale);
  const auto outside = [&](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& other) {
    const Vec3 n = (q - p).cross(r - p);
    return flat || n.dot(-p) * n.dot(other - p) < 0;
  };
  Weights best;
  bool inside = true;
  const auto consider = [&](const Vec3& p, const Vec3& q, const Vec3& r, std::array<std::size_t, 3> index) {
    inside = false;
    const Weights t = on_triangle(p, q, r);
    if (t.distance2 >= best.distance2) return;
    best = {};
    best.distance2 = t.distance2;
    for (std::size_t k = 0; k < 3; ++k) best.w[index[k]] = t.w[k];
  };
  if (outside(a, b, c, d)) consider(a, b, c, {0, 1, 2});
  if (outside(a, b, d, c)) consider(a, b, d, {0, 1, 3});
  if (outside(a, c, d, b)) consider(a, c, d, {0, 2, 3});
  if (outside(b, c, d, a)) consider(b, c, d, {1, 2, 3});
  if (inside) best.distance2 = 0;
  return best;
}

/// Finds the nearest point and drops the points that do not carry it. False if the origin is inside.
bool reduce(Simplex& s) {
  Weights found;
  const auto& p = s.points;
  switch (s.count) {
    case 1: found = {{1, 0, 0, 0}, p[0].w.squaredNorm()}; break;
    case 2: found = on_segment(p[0].w, p[1].w); break;
    case 3: found = on_triangle(p[0].w, p[1].w, p[2].w); break;
    default: found = on_tetrahedron(p[0].w, p[1].w, p[2].w, p[3].w); break;
  }
  if (s.count == 4 && found.distance2 == 0) return false;
  int kept = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(s.count); ++k) {
    if (found.w[k] <= 0) continue;
    s.points[static_cast<std::size_t>(kept)] = s.points[k];
    s.weights[static_cast<std::size_t>(kept++)] = found.w[k];
  }
  s.count = kept;
  return true;
}

}  // namespace

CoreDistance core_distance(const Difference& difference, double margin) {
  const double size = difference.size();
  Vec3 start = difference.a.centre - difference.b.centre;
  if (!(start.norm() > 1e-12 * size)) start = difference.a.rotation.col(0) * size;
  Simplex simplex;
  simplex.points[0] = difference.support(-start);
  simplex.weights[0] = 1;
  simplex.count = 1;
  CoreDistance result;
  result.nearest = simplex.points[0];
  result.distance = result.nearest.w.norm();
  for (int iteration = 0; iteration < 128; ++iteration) {
    const Vec3 v = result.nearest.w;
    const double distance = result.distance;
    if (!(distance > 1e-9 * size)) {
      result.state = CoreDistance::State::touching;
      return result;
    }
    const DifferencePoint p = difference.support(-v);
    const double along = v.dot(p.w);
    if (along > margin * distance) {
      result.state = CoreDistance::State::beyond;
      return result;
    }
    if (distance * distance - along <= 1e-10 * distance * distance + 2e-16 * size * distance) return result;
    simplex.points[static_cast<std::size_t>(simplex.count++)] = p;
    if (!reduce(simplex)) {
      result.state = CoreDistance::State::touching;
      return result;
    }
    const DifferencePoint nearest = simplex.nearest();
    const double next = nearest.w.norm();
    if (!(next < distance)) return result;  // as near as rounding allows
    result.nearest = nearest;
    result.distance = next;
  }
  return result;
}

namespace {

constexpr int max_points = 128, max_faces = 2 * max_points, max_horizon = max_faces;

/// The growing polytope: a closed surface of triangles, outward normals.
class Polytope {
 public:
  explicit Polytope(const Difference& difference) : difference_(difference), size_(difference.size()) {}

  /// A first tetrahedron; false if the difference has no volume.
  bool start() {
    const Mat3& axes = difference_.a.rotation;
    DifferencePoint far[2] = {difference_.support(axes.col(0)), difference_.support(-axes.col(0))};
    for (int k = 1; k < 3 && (far[0].w - far[1].w).norm() < 1e-3 * size_; ++k) {
      far[0] = difference_.support(axes.col(k));
      far[1] = difference_.support(-axes.col(k));
    }
    points_[0] = far[0];
    points_[1] = far[1];
    const Vec3 line = far[1].w - far[0].w;
    const Vec3 u = line.cross(any_perpendicular(line.normalized())), v = line.cross(u);
    double best = 0;
    for (const Vec3& d : {u, Vec3(-u), v, Vec3(-v)}) {
      const DifferencePoint p = difference_.support(d);
      const double area = line.cross(p.w - far[0].w).norm();
      if (area > best) {
        best = area;
        points_[2] = p;
      }
    }
    if (!(best > 1e-9 * size_ * line.norm())) return false;
    const Vec3 n = line.cross(points_[2].w - far[0].w);
    best = 0;
    for (const Vec3& d : {n, Vec3(-n)}) {
      const DifferencePoint p = difference_.support(d);
      const double volume = std::abs(n.dot(p.w - far[0].w));
      if (volume > best) {
        best = volume;
        points_[3] = p;
      }
    }
    if (!(best > 1e-9 * size_ * n.norm())) return false;
    points_used_ = 4;
    inner_ = 0.25 * (points_[0].w + points_[1].w + points_[2].w + points_[3].w);
    return add_face(0, 1, 2) && add_face(0, 3, 1) && add_face(0, 2, 3) && add_face(1, 3, 2);
  }

  CoreDepth expand() {
    CoreDepth best;
    best.depth = std::numeric_limits<double>::infinity();
    while (true) {
      int nearest = -1;
      for (int k = 0; k < faces_used_; ++k)
        if (nearest < 0 || face(k).offset < face(nearest).offset) nearest = k;
      const Face chosen = face(nearest);
      const DifferencePoint p = difference_.support(chosen.normal);
      const double reach = chosen.normal.dot(p.w);
      // Of equally good normals the later one: its face is smaller, and holds the nearest point.
      if (reach <= best.depth + 1e-11 * size_) {
        best.depth = reach;
        best.normal = chosen.normal;
        best.nearest = nearest_foot(chosen.offset + 2e-11 * size_);
      }
      if (reach - chosen.offset <= 1e-11 * size_ || !insert(p)) return best;
    }
  }

 private:
  struct Face {
    std::array<int, 3> corner{};
    Vec3 normal = Vec3::Zero();
    double offset = 0;  ///< normal . w on the face: signed distance from the origin
  };

  const Face& face(int k) const { return faces_[static_cast<std::size_t>(k)]; }
  const DifferencePoint& point(int k) const { return points_[static_cast<std::size_t>(k)]; }

  bool add_face(int i, int j, int k) {
    if (faces_used_ == max_faces) return false;
    Face f{{i, j, k}, (point(j).w - point(i).w).cross(point(k).w - point(i).w), 0};
    const double length = f.normal.norm();
    if (!(length > 1e-24 * size_ * size_)) return false;
    f.normal /= length;
    if (f.normal.dot(point(i).w - inner_) < 0) {
      f.normal = -f.normal;
      std::swap(f.corner[1], f.corner[2]);
    }
    f.offset = f.normal.dot(point(i).w);
    faces_[static_cast<std::size_t>(faces_used_++)] = f;
    return true;
  }

  /// Replaces the faces that see p by a fan around the horizon.
  bool insert(const DifferencePoint& p) {
    if (points_used_ == max_points) return false;
    int edges = 0;
    std::array<std::array<int, 2>, max_horizon> horizon;
    for (int k = 0; k < faces_used_;) {
      const Face f = face(k);
      if (f.normal.dot(p.w) - f.offset <= 1e-14 * size_) {
        ++k;
        continue;
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const std::array<int, 2> edge{f.corner[c], f.corner[(c + 1) % 3]};
        int twin = -1;
        for (int e = 0; e < edges && twin < 0; ++e) {
          const auto& other = horizon[static_cast<std::size_t>(e)];
          if (other[0] == edge[1] && other[1] == edge[0]) twin = e;
        }
        if (twin >= 0) {
          horizon[static_cast<std::size_t>(twin)] = horizon[static_cast<std::size_t>(--edges)];
        } else {
          if (edges == max_horizon) return false;
          horizon[static_cast<std::size_t>(edges++)] = edge;
        }
      }
      faces_[static_cast<std::size_t>(k)] = face(--faces_used_);
    }
    if (edges < 3) return false;
    const int apex = points_used_++;
    points_[static_cast<std::size_t>(apex)] = p;
    for (int e = 0; e < edges; ++e) {
      const auto& edge = horizon[static_cast<std::size_t>(e)];
      if (!add_face(edge[0], edge[1], apex)) return false;
    }
    return true;
  }

  /// A flat side consists of many triangles of one offset: the point nearest to the origin lies in one of them.
  DifferencePoint nearest_foot(double offset) const {
    DifferencePoint best;
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < faces_used_; ++k) {
      if (face(k).offset > offset) continue;
      const DifferencePoint p = foot(face(k));
      if (p.w.squaredNorm() < least) {
        least = p.w.squaredNorm();
        best = p;
      }
    }
    return best;
  }

  DifferencePoint foot(const Face& f) const {
    const DifferencePoint &a = point(f.corner[0]), &b = point(f.corner[1]), &c = point(f.corner[2]);
    const Vec3 o = f.offset * f.normal;
    const Weights w = on_triangle(a.w - o, b.w - o, c.w - o);
    DifferencePoint p;
    p.w = w.w[0] * a.w + w.w[1] * b.w + w.w[2] * c.w;
    p.on_a = w.w[0] * a.on_a + w.w[1] * b.on_a + w.w[2] * c.on_a;
    p.on_b = w.w[0] * a.on_b + w.w[1] * b.on_b + w.w[2] * c.on_b;
    return p;
  }

  const Difference& difference_;
  double size_;
  Vec3 inner_ = Vec3::Zero();
  std::array<DifferencePoint, max_points> points_;
  std::array<Face, max_faces> faces_;
  int points_used_ = 0, faces_used_ = 0;
};

}  // namespace

CoreDepth core_depth(const Difference& difference) {
  Polytope polytope(difference);
  if (polytope.start()) return polytope.expand();
  // No volume: two points, or flat bodies in one plane. Any direction across does.
  CoreDepth result;
  const Vec3 d = difference.b.centre - difference.a.centre;
  const double length = d.norm();
  result.normal = length > 0 ? Vec3(d / length) : Vec3(difference.a.rotation.col(2));
  result.nearest = difference.support(result.normal);
  result.depth = result.normal.dot(result.nearest.w);
  return result;
}

}  // namespace repose::dvi
