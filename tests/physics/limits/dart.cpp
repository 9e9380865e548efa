#include <array>

#include "tests/physics/engine_limits.hpp"

namespace repose::test {

std::span<const EngineLimit> dart_limits() {
  static constexpr std::string_view late = "a contact is felt once the bodies overlap, so up to one step late";
  static constexpr std::string_view apart =
      "bodies that meet overlap by up to a step's way, and are pushed apart while they slide past each other";
  static constexpr std::array table{
      EngineLimit{"bouncing ball, worst distance from the discrete law in 2.5 s [m]", 1e-4, 2e-3, late},
      EngineLimit{"18 grains of 58 um, h = 1e-05 s: largest penetration / d", 1.1e-3, 1e-2, late},
      EngineLimit{"18 grains of 58 um, h = 1e-05 s: largest sink into the floor / R", 2.1e-3, 2e-2, late},
      EngineLimit{"search margin doubled: the wider search sees more contacts", 1, 1,
                  "FCL tells of overlap only: spheres are met when they touch, whatever the margin"},
      EngineLimit{"largest gain here / energy before", 0.3, 0.4,
                  "Newton's law of restitution is taken as it is, with the energy that it gains in Kane's example"},
      EngineLimit{"spinning resistance, speed of the centre / R w0", 1.2e-11, 1.3e-11,
                  "it sinks: a share of 1e-9 of each step's approach g h is left, here 1.226e-11 of R w0"},
      EngineLimit{"twin and sphere, change of angular momentum", 1e-5, 1e-3, apart},
      EngineLimit{"twin and box, change of angular momentum", 1e-5, 1e-3, apart},
      EngineLimit{"collapsing cloud of 60, change of angular momentum", 1e-6, 1e-4, apart},
  };
  return table;
}

}  // namespace repose::test
