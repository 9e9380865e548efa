#pragma once
/// Two states compared byte by byte: what "the same run" means.
#include <cstring>
#include <vector>

#include "core/model.hpp"

namespace repose::test {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(static_cast<const void*>(a.data()), b.data(), a.size() * sizeof(T)) == 0;
}

inline bool same_state(const Snapshot& a, const Snapshot& b) {
  return a.time == b.time && same_bytes(a.position, b.position) && same_bytes(a.orientation, b.orientation) &&
         same_bytes(a.velocity, b.velocity) && same_bytes(a.angular_velocity, b.angular_velocity);
}

}  // namespace repose::test
