#pragma once
/// Short vectors: one contact per lane. Plain arithmetic on them compiles to the widest instructions of the machine.
#include <cmath>
#include <cstdint>
#include <type_traits>

namespace repose::dvi {

inline constexpr int lane_bytes = 64;

template <class Real>
using Lanes [[gnu::vector_size(lane_bytes)]] = Real;

template <class Real>
inline constexpr int lane_count = lane_bytes / static_cast<int>(sizeof(Real));

template <class Real>
[[gnu::always_inline]] inline Lanes<Real> fill(Real x) {
  return Lanes<Real>{} + x;
}

template <class Real>
[[gnu::always_inline]] inline void square_root(Lanes<Real>& x) {
  for (int l = 0; l < lane_count<Real>; ++l) x[l] = std::sqrt(x[l]);
}

}  // namespace repose::dvi
