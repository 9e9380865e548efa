#pragma once
/// Room for arrays that are as long as a step has contacts: millions of bytes each, so it grows by an eighth and not to the double.
#include <cstddef>
#include <vector>

namespace repose::dvi {

template <class T>
void reserve_sparingly(std::vector<T>& array, std::size_t n) {
  if (n > array.capacity()) array.reserve(n + n / 8);
}

template <class T>
void resize_sparingly(std::vector<T>& array, std::size_t n) {
  reserve_sparingly(array, n);
  array.resize(n);
}

}  // namespace repose::dvi
