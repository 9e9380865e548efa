#pragma once
/// Tools: named, parametric assemblies of smooth surfaces. Each becomes one or more non-dynamic bodies.
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/motion.hpp"
#include "core/shape.hpp"

namespace repose {

/// A conical funnel about the vertical axis through `position` (the centre of its outlet), and a slit under it: a thin
/// shutter that is there except between `opens` and `closes`. A shutter that closes lets the grains in its plane pass.
struct Funnel {
  double outlet_diameter = 0;      ///< [m], > 0
  double half_angle_deg = 30;      ///< between the wall and the vertical, in (0, 90)
  double top_diameter = 0;         ///< [m] where the cone ends, > outlet_diameter
  double wall_height = 0;          ///< [m] of the cylinder on top of the cone, >= 0
  double thickness = 0;            ///< of the wall [m], > 0
  double opens = 0;                ///< [s]; the shutter is closed before
  double closes = 1e300;           ///< [s], > opens; closed from then on
};

/// The plate on which the heap stands: a disc whose top is the plane z = position.z, with a rim around it, and around that
/// an overflow trench that catches what falls over the rim.
struct Base {
  double diameter = 0;        ///< inside the rim [m], > 0
  double rim_height = 0;      ///< above the plate [m], >= 0
  double rim_width = 0;       ///< [m], > 0 if rim_height > 0
  double trench_width = 0;    ///< [m], 0: no trench, grains fall over the edge for ever
  double trench_depth = 0;    ///< of the trench's floor below the plate [m]
  double trench_wall = 0;     ///< height of the trench's outer wall above its floor [m]
};

struct Plate { Vec3 size = Vec3::Zero(); };            ///< a box; its top face is centred on `position` [m]
struct Floor { Vec3 normal = Vec3::UnitZ(); };         ///< a half-space through `position`
/// An open or closed box seen from inside: five or six plates around the inner size; `position`: centre of the inner floor.
struct Container { Vec3 inner_size = Vec3::Zero(); double thickness = 0; bool lid = false; };
/// An open cylindrical cup about z; `position`: centre of the inner floor.
struct Cup { double inner_diameter = 0, height = 0, thickness = 0; };
/// A solid cylinder whose axis is y; `position`: its centre.
struct Roller { double diameter = 0, width = 0; };
/// A straight blade, `width` along y; `position`: the middle of its lowest line. `rake_deg` leans its top towards +x (a blade
/// that travels along +x then presses the powder down), negative towards -x. `edge_radius` rounds both lower edges.
struct Blade { double thickness = 0, height = 0, width = 0, rake_deg = 0, edge_radius = 0; };
/// A hollow cylinder whose axis is y, with end walls; `position`: its centre.
struct Drum { double inner_diameter = 0, inner_width = 0, thickness = 0; };

using ToolKind = std::variant<Funnel, Base, Plate, Floor, Container, Cup, Roller, Blade, Drum>;

struct Tool {
  std::string name;
  std::string material;
  ToolKind kind;
  Vec3 position = Vec3::Zero();  ///< [m]
  Motion motion;
  std::optional<Yield> yield = {};  ///< of tools of one piece
};

/// One rigid piece of a tool.
struct ToolBody {
  Shape shape;
  Pose pose;
  std::vector<Interval> active;  ///< empty: always there
};

/// The bodies that a tool consists of, in world coordinates at time 0. Throws Error for impossible dimensions.
std::vector<ToolBody> build_tool(const Tool& tool);

}  // namespace repose
