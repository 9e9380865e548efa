#include "backends/dvi/collide_ellipsoid.hpp"

namespace repose::dvi {

EllipsoidPoint nearest_on_ellipsoid(const Vec3& e, const Vec3& y) {
  int j = 0;
  if (e[1] < e[j]) j = 1;
  if (e[2] < e[j]) j = 2;
  // tau = t + e_j^2 > 0 is the unknown, so that points near the shortest axis' plane lose no digits.
  const Vec3 shift((e[0] - e[j]) * (e[0] + e[j]), (e[1] - e[j]) * (e[1] + e[j]), (e[2] - e[j]) * (e[2] + e[j]));
  const Vec3 ey = e.cwiseProduct(y).cwiseAbs();
  double tau = std::max({0.0, ey[0] - shift[0], ey[1] - shift[1], ey[2] - shift[2], ey.norm() - shift.maxCoeff()});
  EllipsoidPoint result;
  Vec3& den = result.denominator;
  bool pinned = false;
  for (int iteration = 0; iteration < 40; ++iteration) {
    double s = 0, slope = 0;
    for (int i = 0; i < 3; ++i) {
      den[i] = tau + shift[i];
      if (ey[i] == 0) continue;
      const double q = ey[i] / den[i];
      s += q * q;
      slope += q * q / den[i];
    }
    // S(0) < 1 with y_j = 0: the nearest point leaves the plane of symmetry, at either end of the shortest axis.
    if (iteration == 0 && tau == 0 && s < 1) {
      pinned = true;
      break;
    }
    const double root = std::sqrt(s);
    const double step = s * (root - 1) / slope;
    const double next = tau + step;
    if (!(step > 1e-16 * tau) || !(next > tau)) break;
    tau = next;
    if (root - 1 < 1e-9) {  // quadratic: one more step reaches rounding
      for (int i = 0; i < 3; ++i) den[i] = tau + shift[i];
      break;
    }
  }
  double covered = 0;
  for (int i = 0; i < 3; ++i) {
    result.w[i] = ey[i] == 0 ? 0 : y[i] / den[i];
    covered += e[i] * e[i] * result.w[i] * result.w[i];
  }
  if (pinned) result.w[j] = std::sqrt(std::max(0.0, 1 - covered)) / e[j];
  result.t = tau - e[j] * e[j];
  result.w_norm = result.w.norm();
  return result;
}

Mat3 distance_hessian(const Vec3& e, const EllipsoidPoint& nearest) {
  const Vec3 n = nearest.normal();
  const Vec3 d = nearest.denominator.cwiseMax(1e-12 * e.squaredNorm()).cwiseInverse();
  const Vec3 dw = d.cwiseProduct(nearest.w);
  const Vec3 dx = e.cwiseProduct(e).cwiseProduct(dw);
  Mat3 h = d.asDiagonal();
  h -= dw * dx.transpose() / dx.dot(nearest.w);
  h -= n * (n.transpose() * h);
  return h / nearest.w_norm;
}

PointDistance point_distance(const PlacedEllipsoid& ellipsoid, const Vec3& point) {
  const EllipsoidPoint nearest =
      nearest_on_ellipsoid(ellipsoid.semi_axes, ellipsoid.rotation.transpose() * (point - ellipsoid.centre));
  return {nearest.distance(), ellipsoid.rotation * nearest.normal()};
}

namespace {

struct SupportPair {
  Vec3 an, bn;
  double ha, hb, value;
};

SupportPair evaluate(const Vec3& n, const Vec3& d, const Mat3& a, const Mat3& b) {
  SupportPair s;
  s.an.noalias() = a * n;
  s.bn.noalias() = b * n;
  s.ha = std::sqrt(n.dot(s.an));
  s.hb = std::sqrt(n.dot(s.bn));
  s.value = n.dot(d) - s.ha - s.hb;
  return s;
}

Vec3 solve_symmetric(const Mat3& m, const Vec3& rhs) {
  const Vec3 c0 = m.col(1).cross(m.col(2)), c1 = m.col(2).cross(m.col(0)), c2 = m.col(0).cross(m.col(1));
  return Vec3(c0.dot(rhs), c1.dot(rhs), c2.dot(rhs)) / m.col(0).dot(c0);
}

/// Ascends F from `n`. Riemannian Newton: with tangent basis T, Hessian -T^T (Ha + Hb) T - F I, Ha = (A - x x^T) / h.
EllipsoidGap ascend(Vec3 n, const Vec3& d, const Mat3& a, const Mat3& b, double margin) {
  SupportPair s = evaluate(n, d, a, b);
  for (int iteration = 0; iteration < 60; ++iteration) {
    if (s.value > margin) return {n, s.value, true};
    const Vec3 xa = s.an / s.ha, xb = s.bn / s.hb;
    const Vec3 g = d - xa - xb;
    // A tangent basis without branches (Duff et al. 2017).
    const double sign = std::copysign(1.0, n.z()), p = -1 / (sign + n.z()), q = n.x() * n.y() * p;
    const Vec3 t0(1 + sign * n.x() * n.x() * p, sign * q, -sign * n.x()), t1(q, sign + n.y() * n.y() * p, -n.y());
    const double g0 = g.dot(t0), g1 = g.dot(t1);
    const double size = s.ha + s.hb + std::abs(s.value);
    if (g0 * g0 + g1 * g1 <= 1e-28 * size * size) break;
    const Mat3 m = a / s.ha + b / s.hb;
    const Vec3 m0 = m * t0, m1 = m * t1;
    const double xa0 = xa.dot(t0), xa1 = xa.dot(t1), xb0 = xb.dot(t0), xb1 = xb.dot(t1);
    double h00 = m0.dot(t0) - xa0 * xa0 / s.ha - xb0 * xb0 / s.hb + s.value;
    double h11 = m1.dot(t1) - xa1 * xa1 / s.ha - xb1 * xb1 / s.hb + s.value;
    const double h01 = m0.dot(t1) - xa0 * xa1 / s.ha - xb0 * xb1 / s.hb;
    // Where F is not concave along the sphere (deep overlap), shift the Hessian until the step ascends.
    const double half = 0.5 * (h00 + h11), radius = std::sqrt(0.25 * (h00 - h11) * (h00 - h11) + h01 * h01);
    const double floor = 1e-9 * (half + radius > 0 ? half + radius : size);
    if (half - radius < floor) {
      const double shift = std::max(floor, 0.1 * radius) - (half - radius);
      h00 += shift;
      h11 += shift;
    }
    const double det = h00 * h11 - h01 * h01;
    double s0 = (h11 * g0 - h01 * g1) / det, s1 = (h00 * g1 - h01 * g0) / det;
    const double length2 = s0 * s0 + s1 * s1;
    if (length2 > 1) {
      const double shrink = 1 / std::sqrt(length2);
      s0 *= shrink;
      s1 *= shrink;
    }
    const double rise = g0 * s0 + g1 * s1;
    bool moved = false;
    for (double step = 1; step > 1e-6; step *= 0.5) {
      const Vec3 trial = (n + step * (s0 * t0 + s1 * t1)).normalized();
      const SupportPair ts = evaluate(trial, d, a, b);
      // Below rounding of F the Newton step is trusted without ascent.
      if (ts.value >= s.value + 1e-4 * step * rise || (step == 1 && rise <= 1e-13 * size)) {
        n = trial;
        s = ts;
        moved = true;
        break;
      }
    }
    if (!moved || length2 <= 1e-18) break;
  }
  return {n, s.value, s.value > margin};
}

}  // namespace

EllipsoidGap ellipsoid_gap(const PlacedEllipsoid& first, const PlacedEllipsoid& second, double margin) {
  const Vec3 d = second.centre - first.centre;
  const Mat3 a = support_matrix(first), b = support_matrix(second);
  const double distance = d.norm();
  Vec3 n = distance > 0 ? Vec3(d / distance) : Vec3(first.rotation.col(2));
  // At the optimum d = (A/ha + B/hb + F) n: iterate it as a fixed point for a good start.
  for (int k = 0; k < 2; ++k) {
    const SupportPair s = evaluate(n, d, a, b);
    if (s.value > margin) return {n, s.value, true};
    Mat3 m = a / s.ha + b / s.hb;
    m.diagonal().array() += std::max(0.0, s.value);
    const Vec3 next = solve_symmetric(m, d);
    const double length = next.norm();
    if (!(length > 0) || !std::isfinite(length)) break;
    n = next / length;
  }
  EllipsoidGap best = ascend(n, d, a, b, margin);
  const double smallest = std::min(first.semi_axes.minCoeff(), second.semi_axes.minCoeff());
  if (best.beyond || best.gap > -0.2 * smallest) return best;
  for (const Mat3* axes : {&first.rotation, &second.rotation})
    for (int k = 0; k < 3; ++k) {
      const Vec3 start = axes->col(k);
      const EllipsoidGap other = ascend(start.dot(d) < 0 ? Vec3(-start) : start, d, a, b, margin);
      if (other.gap > best.gap + 1e-12 * smallest) best = other;
    }
  return best;
}

void collide_ellipsoids(const PlacedEllipsoid& a, const PlacedEllipsoid& b, const ContactSink& sink) {
  const double reach = a.semi_axes.maxCoeff() + b.semi_axes.maxCoeff() + sink.margin;
  if ((b.centre - a.centre).squaredNorm() > reach * reach) return;
  const EllipsoidGap found = ellipsoid_gap(a, b, sink.margin);
  if (found.beyond) return;
  const Vec3& n = found.normal;
  const Vec3 local = a.semi_axes.cwiseProduct(a.rotation.transpose() * n);
  const Vec3 witness = a.centre + a.rotation * a.semi_axes.cwiseProduct(local) / local.norm();
  sink.add(witness + 0.5 * found.gap * n, n, found.gap, 0);
}

void collide_sphere_ellipsoid(const PlacedSphere& a, const PlacedEllipsoid& b, const ContactSink& sink) {
  const double reach = a.radius + b.semi_axes.maxCoeff() + sink.margin;
  if ((a.centre - b.centre).squaredNorm() > reach * reach) return;
  const PointDistance d = point_distance(b, a.centre);
  const double gap = d.distance - a.radius;
  sink.add(a.centre - (a.radius + 0.5 * gap) * d.normal, -d.normal, gap, 0);
}

}  // namespace repose::dvi
