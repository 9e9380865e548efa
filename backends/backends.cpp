#include "backends/backends.hpp"

#include <array>

#include "backends/bullet/world_bullet.hpp"
#include "backends/dvi/world_dvi.hpp"
#ifdef REPOSE_HAS_DART
#include "backends/dart/world_dart.hpp"
#endif
#include "core/error.hpp"

namespace repose {

std::span<const Backend> backends() {
  static const std::array table{
      Backend{"dvi",
              "non-smooth dynamics: cone complementarity with rolling and spinning friction and cohesion, large steps",
              dvi::unsupported, dvi::make_world, true, true},
      Backend{"bullet", "Bullet 3.24, in double precision: rigid contacts by sequential impulses, a reference engine",
              bullet::unsupported, bullet::make_world},
#ifdef REPOSE_HAS_DART
      Backend{"dart", "DART 6.12: collision by FCL, each island of contacts solved directly; a reference for small scenes",
              dart::unsupported, dart::make_world, true, false, 100},
#endif
  };
  return table;
}

const Backend& find_backend(std::string_view name) {
  std::string known;
  for (const Backend& backend : backends()) {
    if (backend.name == name) return backend;
    known += (known.empty() ? "" : ", ") + backend.name;
  }
  throw Error("--backend", "there is no backend \"" + std::string(name) + "\"", "known backends: " + known);
}

}  // namespace repose
