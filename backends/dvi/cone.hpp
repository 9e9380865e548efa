#pragma once
/// The cone of one contact, K = { p >= 0, |g_t| <= mu p, |g_r| <= rho p, |g_s| <= sigma p }, and the Euclidean projection on it.
///
/// With the distances d_k of the three friction parts from zero, the projection of (a, g_t, g_r, g_s) has the p that minimises
///   (p - a)^2 + sum_k max(0, d_k - mu_k p)^2  over p >= 0,
/// a convex, piecewise quadratic function of one variable; each friction part is then shortened to mu_k p where it is longer.
/// The derivative  p - a - sum_k mu_k max(0, d_k - mu_k p)  is increasing and concave, so Newton's method started with all
/// parts sliding climbs to the root without passing it and meets each of the three kinks at most once: exact in four steps.
#include "backends/dvi/lanes.hpp"

namespace repose::dvi {

namespace detail {
template <class T>
[[gnu::always_inline]] inline void root(T& x) {
  if constexpr (std::is_floating_point_v<T>) {
    x = std::sqrt(x);
  } else {
    square_root<std::remove_cvref_t<decltype(x[0])>>(x);
  }
}
}  // namespace detail

/// Projects in place. T: a floating point number, or lanes of them. `p` is measured from the apex of the cone (cohesion
/// added to the normal impulse); all coefficients >= 0. NaN in, NaN out.
template <class T>
[[gnu::always_inline]] inline void project_on_cone(T& p, T& t1, T& t2, T& r1, T& r2, T& s, const T& mu, const T& rho,
                                                   const T& sigma) {
  const T zero = T{};
  const T one = zero + 1;
  T dt = t1 * t1 + t2 * t2, dr = r1 * r1 + r2 * r2, ds = s * s;
  detail::root(dt);
  detail::root(dr);
  detail::root(ds);
  T x = (p + mu * dt + rho * dr + sigma * ds) / (one + mu * mu + rho * rho + sigma * sigma);
  x = x > zero ? x : (x <= zero ? zero : x);
  for (int newton = 0; newton < 3; ++newton) {
    const T mt = dt > mu * x ? mu : zero;
    const T mr = dr > rho * x ? rho : zero;
    const T ms = ds > sigma * x ? sigma : zero;
    const T y = (p + mt * dt + mr * dr + ms * ds) / (one + mt * mt + mr * mr + ms * ms);
    // At the apex all parts slide and the start is exact; rounding must not lift it off.
    x = x > zero ? (y > x ? y : x) : x;
  }
  const T lt = dt > mu * x ? mu * x / dt : one;
  const T lr = dr > rho * x ? rho * x / dr : one;
  const T ls = ds > sigma * x ? sigma * x / ds : one;
  p = x;
  t1 = t1 * lt;
  t2 = t2 * lt;
  r1 = r1 * lr;
  r2 = r2 * lr;
  s = s * ls;
}

}  // namespace repose::dvi
