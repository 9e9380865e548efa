#pragma once
/// Short vectors: one contact per lane, as wide as the registers of the machine. (Arithmetic on wider ones would still be
/// parted into registers, but GCC 12 takes comparisons, choices and shuffles of them lane by lane: a sweep then takes five times
/// as long.) So the order of the contacts in a sweep, and with it the last digits, belong to the kind of machine.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace repose::dvi {

#if defined(__AVX512F__)
inline constexpr int lane_bytes = 64;
#elif defined(__AVX__)
inline constexpr int lane_bytes = 32;
#else
inline constexpr int lane_bytes = 16;
#endif

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

/// Numbers of a record, and how many lanes take their records side by side in eight rows.
inline constexpr int record_size = 8;
template <class Real>
inline constexpr int block_lanes = lane_count<Real> < record_size ? lane_count<Real> : record_size;

/// Turns blocks of block_lanes rows into columns, in place: its own inverse. (Lanes written one by one and read as a whole stall
/// the processor for longer than the arithmetic of a contact takes.)
template <class Real>
[[gnu::always_inline]] inline void transpose(Lanes<Real>* row) {
  exchange<Real, 1>(row);
  if constexpr (block_lanes<Real> > 2) exchange<Real, 2>(row);
  if constexpr (block_lanes<Real> > 4) exchange<Real, 4>(row);
}

template <class Real>
using HalfLanes [[gnu::vector_size(lane_bytes / 2)]] = Real;

/// Reads one record of 8 numbers per lane: column k holds number k of every lane's record.
template <class Real>
[[gnu::always_inline]] inline void load_records(const Real* records, const std::int32_t* index, Lanes<Real>* column) {
  const auto record = [&](int lane) { return records + record_size * static_cast<std::ptrdiff_t>(index[lane]); };
  if constexpr (lane_count<Real> == 2 * record_size) {
#pragma GCC unroll 8
    for (int i = 0; i < record_size; ++i) {
      HalfLanes<Real> first, second;
      __builtin_memcpy(&first, record(i), sizeof(first));
      __builtin_memcpy(&second, record(i + record_size), sizeof(second));
      column[i] = __builtin_shufflevector(first, second, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    }
  } else {  // a record is one row or several, a block apart
    constexpr int n = block_lanes<Real>;
#pragma GCC unroll 8
    for (int i = 0; i < record_size; ++i) __builtin_memcpy(&column[i], record(i % n) + i / n * n, lane_bytes);
  }
  transpose<Real>(column);
}

/// Writes the records back, for the lanes whose index is below `limit`. `column` is used up.
template <class Real>
[[gnu::always_inline]] inline void store_records(Real* records, std::int32_t limit, const std::int32_t* index,
                                                 Lanes<Real>* column) {
  transpose<Real>(column);
  const auto store = [&](int lane, int from, const auto& numbers) {
    if (index[lane] < limit)
      __builtin_memcpy(records + record_size * static_cast<std::ptrdiff_t>(index[lane]) + from, &numbers, sizeof(numbers));
  };
#pragma GCC unroll 8
  for (int i = 0; i < record_size; ++i) {
    if constexpr (lane_count<Real> == 2 * record_size) {
      store(i, 0, __builtin_shufflevector(column[i], column[i], 0, 1, 2, 3, 4, 5, 6, 7));
      store(i + record_size, 0, __builtin_shufflevector(column[i], column[i], 8, 9, 10, 11, 12, 13, 14, 15));
    } else {
      constexpr int n = block_lanes<Real>;
      store(i % n, i / n * n, column[i]);
    }
  }
}

}  // namespace repose::dvi
