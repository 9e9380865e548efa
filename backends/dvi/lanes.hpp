#pragma once
/// Short vectors: one contact per lane. Plain arithmetic on them compiles to the widest instructions of the machine.
#include <cmath>
#include <cstddef>
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

/// Integers as wide as Real, to name lanes in a shuffle.
template <class Real>
using LaneIndex [[gnu::vector_size(lane_bytes)]] = std::conditional_t<sizeof(Real) == 8, std::int64_t, std::int32_t>;

template <class Real>
using HalfLanes [[gnu::vector_size(lane_bytes / 2)]] = Real;

/// One round of a transposition: exchanges blocks of `Size` lanes between rows that lie `Size` apart.
template <class Real, int Size>
[[gnu::always_inline]] inline void exchange(Lanes<Real>* row) {
  constexpr int n = lane_count<Real>;
  constexpr auto mask = [](bool high) {
    LaneIndex<Real> index{};
    for (int l = 0; l < n; ++l) index[l] = ((l & Size) != 0) ? (high ? n + l : n + l - Size) : (high ? l + Size : l);
    return index;
  };
  const LaneIndex<Real> low = mask(false), high = mask(true);
#pragma GCC unroll 8
  for (int i = 0; i < 8; ++i) {
    if (i & Size) continue;
    const Lanes<Real> a = row[i], b = row[i + Size];
    row[i] = __builtin_shuffle(a, b, low);
    row[i + Size] = __builtin_shuffle(a, b, high);
  }
}

/// Turns 8 rows of 8 (two such blocks side by side with 16 lanes) into columns, in place: its own inverse. (Lanes written one
/// by one and read as a whole stall the processor for longer than the arithmetic of a contact takes.)
template <class Real>
[[gnu::always_inline]] inline void transpose(Lanes<Real>* row) {
  exchange<Real, 1>(row);
  exchange<Real, 2>(row);
  exchange<Real, 4>(row);
}

/// Reads one record of 8 numbers per lane: column k holds number k of every lane's record.
template <class Real>
[[gnu::always_inline]] inline void load_records(const Real* records, const std::int32_t* index, Lanes<Real>* column) {
#pragma GCC unroll 8
  for (int i = 0; i < 8; ++i) {
    if constexpr (lane_count<Real> == 8) {
      __builtin_memcpy(&column[i], records + 8 * static_cast<std::ptrdiff_t>(index[i]), lane_bytes);
    } else {
      HalfLanes<Real> first, second;
      __builtin_memcpy(&first, records + 8 * static_cast<std::ptrdiff_t>(index[i]), sizeof(first));
      __builtin_memcpy(&second, records + 8 * static_cast<std::ptrdiff_t>(index[i + 8]), sizeof(second));
      column[i] = __builtin_shufflevector(first, second, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    }
  }
  transpose<Real>(column);
}

/// Writes the records back, for the lanes whose index is below `limit`. `column` is used up.
template <class Real>
[[gnu::always_inline]] inline void store_records(Real* records, std::int32_t limit, const std::int32_t* index,
                                                 Lanes<Real>* column) {
  transpose<Real>(column);
  const auto store = [&](int lane, const auto& record) {
    if (index[lane] < limit)
      __builtin_memcpy(records + 8 * static_cast<std::ptrdiff_t>(index[lane]), &record, sizeof(record));
  };
#pragma GCC unroll 8
  for (int i = 0; i < 8; ++i) {
    if constexpr (lane_count<Real> == 8) {
      store(i, column[i]);
    } else {
      store(i, __builtin_shufflevector(column[i], column[i], 0, 1, 2, 3, 4, 5, 6, 7));
      store(i + 8, __builtin_shufflevector(column[i], column[i], 8, 9, 10, 11, 12, 13, 14, 15));
    }
  }
}

}  // namespace repose::dvi
