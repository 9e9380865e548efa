#include "backends/dvi/collide_gjk.hpp"
#include "backends/dvi/collide_simplex.hpp"

namespace repose::dvi {

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
