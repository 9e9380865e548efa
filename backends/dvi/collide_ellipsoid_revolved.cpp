#include "backends/dvi/collide_ellipsoid.hpp"
#include "backends/dvi/collide_revolved.hpp"

namespace repose::dvi {

namespace {

constexpr int samples = 16;  // starts round the axis where one start could miss a contact
constexpr double slack = 1e-9;

Vec3 turned(const Vec3& e) { return {-e.y(), e.x(), 0}; }

/// A function of the azimuth with its first two derivatives; `e` is the radial unit vector.
struct Azimuth {
  Vec3 e;
  double value = 0, first = 0, second = 0;
};

/// Newton's method with a line search on the circle: a minimum of f near the start.
template <class F>
Azimuth descend(const F& f, const Vec3& start) {
  Azimuth now = f(start);
  for (int k = 0; k < 40; ++k) {
    double step = now.second > 0 ? -now.first / now.second : -std::copysign(0.3, now.first);
    step = std::clamp(step, -0.5, 0.5);
    if (now.first == 0) break;
    bool moved = false;
    for (int half = 0; half < 30; ++half, step *= 0.5) {
      const Azimuth trial = f((now.e + step * turned(now.e)).normalized());
      if (trial.value <= now.value || (std::abs(step) < 1e-6 && std::abs(trial.first) < std::abs(now.first))) {
        now = trial;
        moved = true;
        break;
      }
    }
    if (!moved || std::abs(step) < 1e-13) break;
  }
  return now;
}

/// Calls use(Azimuth) for the minimum near `start`, or for all minima over the circle.
template <class F, class Use>
void for_each_minimum(const F& f, const Vec3& start, bool all, const Use& use) {
  if (!all) {
    use(descend(f, start));
    return;
  }
  std::array<Azimuth, samples> ring;
  Vec3 e = start;
  constexpr double c = 0.92387953251128674, s = 0.38268343236508977;  // a sixteenth of a turn
  for (Azimuth& sample : ring) {
    sample = f(e);
    e = (c * e + s * turned(e)).normalized();
  }
  bool any = false;
  for (std::size_t k = 0; k < samples; ++k)
    if (ring[k].value <= ring[(k + 1) % samples].value && ring[k].value < ring[(k + samples - 1) % samples].value) {
      use(descend(f, ring[k].e));
      any = true;
    }
  if (!any) use(ring[0]);
}

/// The ellipsoid in the frame and unit of the solid, with what it has found there.
class EllipsoidOnProfile {
 public:
  EllipsoidOnProfile(const PlacedEllipsoid& a, const PlacedProfile& b, const ContactSink& sink)
      : solid_(b),
        profile_(b.profile),
        sink_(sink),
        margin_(sink.margin / b.scale),
        local_{b.to_local(a.centre), b.rotation.transpose() * a.rotation, a.semi_axes / b.scale},
        q_(support_matrix(local_)),
        largest_(local_.semi_axes.maxCoeff()),
        smallest_(local_.semi_axes.minCoeff()),
        bluntest_(largest_ * largest_ / smallest_),
        at_(local_.centre) {}

  bool run() {
    const ProfileNearest nearest = nearest_on_profile(profile_, at_.point);
    if (nearest.distance > largest_ + margin_) return true;
    if (nearest.distance <= 0) {
      if (solid_.convex) return false;
      inside(nearest.feature);
    } else {
      for (int k = 0; k < profile_.size(); ++k) {
        if (profile_.is_surface(k) && edge_in_reach(k)) edge(k, false);
        if (profile_.is_convex(k) && (at_.point - profile_.point(k)).norm() <= largest_ + margin_) circle(k);
      }
    }
    if (count_ == 0 && !solid_.convex) pierced(nearest);
    return emit();
  }

 private:
  struct Found {
    Vec3 point, normal;  // midpoint; from the ellipsoid to the solid
    double gap;
    std::uint32_t feature;
  };

  bool edge_in_reach(int k) const {
    const double reach = largest_ + margin_;
    const Vec2 d = at_.point - profile_.point(k), dir = profile_.direction(k), n = profile_.normal(k);
    const double side = n.dot(d), along = d.dot(dir), length = dir.norm();
    return side > 0 && side <= reach && along > -reach * length && along < (length + reach) * length;
  }

  void inside(ProfileFeature feature) {
    if (!feature.vertex) {
      edge(feature.index, true);
      return;
    }
    const int in = profile_.previous(feature.index);
    if (profile_.is_surface(in)) edge(in, true);
    if (profile_.is_surface(feature.index)) edge(feature.index, true);
    for (int k = 1; k < count_; ++k)
      if (found_[static_cast<std::size_t>(k)].gap > found_[0].gap) found_[0] = found_[static_cast<std::size_t>(k)];
    count_ = std::min(count_, 1);
  }

  /// The nearest surface point lies inside the ellipsoid, yet no feature has a stationary point of its own: a deep
  /// overlap with a rim. The plane through that point, square to the line to the centre, parts the two.
  void pierced(const ProfileNearest& nearest) {
    const Vec3 n = at_.lift(nearest.normal), foot = local_.centre - nearest.distance * n;
    if (nearest_on_ellipsoid(local_.semi_axes, local_.rotation.transpose() * (foot - local_.centre)).t >= 0) return;
    const Vec3 qn = q_ * n;
    const double h = std::sqrt(n.dot(qn)), gap = nearest.distance - h;
    add({local_.centre - qn / h - 0.5 * gap * n, -n, gap, 4 * nearest.feature.id() + 3});
  }

  /// G(phi) = n(phi).c - k - h(n(phi)): largest on a surface that bulges (convex pair), least in a hollow.
  void edge(int k, bool anywhere) {
    const Vec2 n2 = profile_.normal(k), start = profile_.point(k), dir = profile_.direction(k);
    const double offset = n2.dot(start), sign = n2.x() > 0 ? -1 : 1;
    const auto g = [&](const Vec3& e) {
      const Vec3 n(n2.x() * e.x(), n2.x() * e.y(), n2.y()), slope = n2.x() * turned(e);
      const Vec3 qn = q_ * n;
      const double h = std::sqrt(n.dot(qn));
      const Vec3 support = local_.centre - qn / h;
      const double across = slope.dot(qn) / h;
      return Azimuth{e, sign * (n.dot(local_.centre) - offset - h), sign * slope.dot(support),
                     sign * (-n2.x() * e.dot(support) - (slope.dot(q_ * slope) - across * across) / h)};
    };
    std::uint32_t index = 0;
    const auto use = [&](const Azimuth& best) {
      const double gap = sign * best.value;
      if (!(gap <= margin_)) return;
      const Vec3 n(n2.x() * best.e.x(), n2.x() * best.e.y(), n2.y());
      const Vec3 qn = q_ * n;
      const Vec3 support = local_.centre - qn / std::sqrt(n.dot(qn));
      const double r =
          n2.x() == 0 ? std::sqrt(support.x() * support.x() + support.y() * support.y()) : best.e.dot(support);
      const double along = (Vec2(r, support.z()) - gap * n2 - start).dot(dir), length2 = dir.squaredNorm();
      if (!anywhere && (along < -slack * length2 || along > (1 + slack) * length2)) return;
      add({support - 0.5 * gap * n, -n, gap, 4 * ProfileFeature{k, false}.id() + index++});
    };
    if (n2.x() == 0) {
      use(g(at_.radial));
      return;
    }
    const double narrowest = std::min(start.x(), profile_.point(profile_.next(k)).x());
    for_each_minimum(g, at_.radial, !anywhere && sign > 0 && narrowest < bluntest_ + largest_, use);
  }

  /// D(phi): signed distance of the circle's points from the ellipsoid.
  void circle(int k) {
    const Vec2 v = profile_.point(k);
    const Mat3& rotation = local_.rotation;
    const auto nearest = [&](const Vec3& p) {
      return nearest_on_ellipsoid(local_.semi_axes, rotation.transpose() * (p - local_.centre));
    };
    const auto d = [&](const Vec3& e) {
      const EllipsoidPoint near = nearest(v.x() * e + Vec3(0, 0, v.y()));
      const Vec3 n = rotation * near.normal(), slope = v.x() * turned(e), own = rotation.transpose() * slope;
      return Azimuth{e, near.distance(), n.dot(slope),
                     -v.x() * n.dot(e) + own.dot(distance_hessian(local_.semi_axes, near) * own)};
    };
    std::uint32_t index = 0;
    const auto use = [&](const Azimuth& best) {
      if (!(best.value <= margin_)) return;
      const Vec3 p = v.x() * best.e + Vec3(0, 0, v.y());
      const Vec3 n = rotation * nearest(p).normal();
      // A point on the axis belongs to every azimuth: take the one that the normal lies in.
      const double across = v.x() > 0 ? n.dot(best.e) : -std::sqrt(n.x() * n.x() + n.y() * n.y());
      if (!profile_.in_vertex_cone(k, Vec2(-across, -n.z()), slack)) return;
      add({p - 0.5 * best.value * n, n, best.value, 4 * ProfileFeature{k, true}.id() + index++});
    };
    if (v.x() == 0)
      use(d(at_.radial));
    else
      for_each_minimum(d, at_.radial, v.x() < 4 * largest_, use);
  }

  void add(const Found& f) {
    for (int k = 0; k < count_; ++k) {
      const Found& other = found_[static_cast<std::size_t>(k)];
      if ((f.point - other.point).squaredNorm() < 1e-8 * largest_ * largest_ && f.normal.dot(other.normal) > 0.999)
        return;
    }
    if (count_ < static_cast<int>(found_.size())) found_[static_cast<std::size_t>(count_++)] = f;
  }

  bool emit() const {
    int least = 0;
    for (int k = 1; k < count_; ++k)
      if (found_[static_cast<std::size_t>(k)].gap > found_[static_cast<std::size_t>(least)].gap) least = k;
    // Two convex bodies: each direction found bounds the gap from below, so the largest value is the gap; but a deep
    // overlap may have its best direction elsewhere.
    if (solid_.convex && (count_ == 0 || found_[static_cast<std::size_t>(least)].gap < -0.05 * smallest_)) return false;
    for (int k = 0; k < count_; ++k) {
      if (solid_.convex && k != least) continue;
      const Found& f = found_[static_cast<std::size_t>(k)];
      sink_.add(solid_.to_world(f.point), solid_.rotation * f.normal, solid_.scale * f.gap, f.feature);
    }
    return true;
  }

  const PlacedProfile& solid_;
  const Profile& profile_;
  const ContactSink& sink_;
  double margin_;
  PlacedEllipsoid local_;
  Mat3 q_;
  double largest_, smallest_, bluntest_;
  HalfPlane at_;
  std::array<Found, 24> found_;
  int count_ = 0;
};

}  // namespace

bool collide_ellipsoid_profile(const PlacedEllipsoid& a, const PlacedProfile& b, const ContactSink& sink) {
  return EllipsoidOnProfile(a, b, sink).run();
}

}  // namespace repose::dvi
