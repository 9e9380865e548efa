#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/recording_model.hpp"

// Each struct lists its fields once, in `fields`; writing and reading both follow that list. A new shape or effect needs
// one line there and one in `tag`, and does not compile without them.

namespace repose {
namespace {

using Json = nlohmann::json;

// ---- the fields of each struct ----

template <class Io> void fields(Io& io, Material& x) { io("name", x.name); io("density", x.density); }
template <class Io> void fields(Io& io, PairLaw& x) {
  io("friction", x.friction);
  io("rolling_friction", x.rolling_friction);
  io("spinning_friction", x.spinning_friction);
  io("rolling_friction_length", x.rolling_friction_length);
  io("spinning_friction_length", x.spinning_friction_length);
  io("friction_arm", x.friction_arm);
  io("restitution", x.restitution);
  io("cohesion", x.cohesion);
  io("cohesion_range", x.cohesion_range);
}
template <class Io> void fields(Io& io, Pose& x) { io("position", x.position); io("orientation", x.orientation); }
template <class Io> void fields(Io& io, Interval& x) { io("from", x.from); io("to", x.to); }
template <class Io> void fields(Io& io, Yield& x) {
  io("load", x.load);
  io("mass", x.mass);
}
template <class Io> void fields(Io& io, Motion& x) {
  io("velocity", x.velocity);
  io("angular_velocity", x.angular_velocity);
  io("pivot", x.pivot);
  io("start", x.start);
  io("stop", x.stop);
  io("vibration_amplitude", x.vibration_amplitude);
  io("vibration_frequency", x.vibration_frequency);
  io("vibration_phase", x.vibration_phase);
}
template <class Io> void fields(Io& io, Sphere& x) { io("radius", x.radius); }
template <class Io> void fields(Io& io, Ellipsoid& x) { io("semi_axes", x.semi_axes); }
template <class Io> void fields(Io& io, RoundCone& x) {
  io("radius_a", x.radius_a);
  io("radius_b", x.radius_b);
  io("length", x.length);
}
template <class Io> void fields(Io& io, Cone& x) { io("radius", x.radius); io("height", x.height); }
template <class Io> void fields(Io& io, Box& x) { io("half_extents", x.half_extents); }
template <class Io> void fields(Io& io, Cylinder& x) { io("radius", x.radius); io("half_height", x.half_height); }
template <class Io> void fields(Io& io, HalfSpace& x) { io("normal", x.normal); }
template <class Io> void fields(Io& io, Revolved& x) { io("profile", x.profile); }
template <class Io> void fields(Io& io, TriMesh& x) { io("vertices", x.vertices); io("triangles", x.triangles); }
template <class Io> void fields(Io& io, Part& x) { io("primitive", x.primitive); io("pose", x.pose); }
template <class Io> void fields(Io& io, MassProperties& x) {
  io("volume", x.volume);
  io("centre", x.centre);
  io("inertia", x.inertia);
}
template <class Io> void fields(Io& io, Shape& x) {
  io("kind", x.kind);
  io("parts", x.parts);
  io("mass", x.mass);
  io("own_frame", x.own_frame);
  io("bounding_radius", x.bounding_radius);
}
template <class Io> void fields(Io& io, PeriodicCell& x) { io("lower", x.lower); io("upper", x.upper); }
template <class Io> void fields(Io& io, GravityTilt& x) { io("x_deg", x.x_deg); io("y_deg", x.y_deg); }
template <class Io> void fields(Io& io, UniformForce& x) { io("force", x.force); }
template <class Io> void fields(Io& io, LinearDrag& x) { io("viscosity", x.viscosity); }
template <class Io> void fields(Io& io, QuadraticDrag& x) {
  io("coefficient", x.coefficient);
  io("fluid_density", x.fluid_density);
}
template <class Io> void fields(Io& io, FiniteReynoldsDrag& x) {
  io("viscosity", x.viscosity);
  io("fluid_density", x.fluid_density);
}
template <class Io> void fields(Io& io, Buoyancy& x) { io("fluid_density", x.fluid_density); }
template <class Io> void fields(Io& io, Magnus& x) { io("lift", x.lift); io("fluid_density", x.fluid_density); }
template <class Io> void fields(Io& io, PeriodicForce& x) {
  io("amplitude", x.amplitude);
  io("frequency", x.frequency);
  io("phase", x.phase);
}
template <class Io> void fields(Io& io, RateDependentFriction& x) {
  io("slope", x.slope);
  io("reference_speed", x.reference_speed);
}
template <class Io> void fields(Io& io, AnisotropicFriction& x) {
  io("ratio", x.ratio);
  io("direction_deg", x.direction_deg);
}
template <class Io> void fields(Io& io, RateDependentRestitution& x) {
  io("exponent", x.exponent);
  io("reference_speed", x.reference_speed);
}
template <class Io> void fields(Io& io, LiquidBridge& x) { io("force", x.force); io("rupture", x.rupture); }
template <class Io> void fields(Io& io, ContactCompliance& x) {
  io("stiffness", x.stiffness);
  io("damping", x.damping);
}

// ---- the names of the alternatives of a variant ----

const char* tag(const Sphere&) { return "sphere"; }
const char* tag(const Ellipsoid&) { return "ellipsoid"; }
const char* tag(const RoundCone&) { return "round_cone"; }
const char* tag(const Cone&) { return "cone"; }
const char* tag(const Box&) { return "box"; }
const char* tag(const Cylinder&) { return "cylinder"; }
const char* tag(const HalfSpace&) { return "half_space"; }
const char* tag(const Revolved&) { return "revolved"; }
const char* tag(const TriMesh&) { return "tri_mesh"; }
const char* tag(const GravityTilt&) { return "gravity_tilt"; }
const char* tag(const UniformForce&) { return "uniform_force"; }
const char* tag(const LinearDrag&) { return "linear_drag"; }
const char* tag(const QuadraticDrag&) { return "quadratic_drag"; }
const char* tag(const FiniteReynoldsDrag&) { return "finite_reynolds_drag"; }
const char* tag(const Buoyancy&) { return "buoyancy"; }
const char* tag(const Magnus&) { return "magnus"; }
const char* tag(const PeriodicForce&) { return "periodic_force"; }
const char* tag(const RateDependentFriction&) { return "rate_dependent_friction"; }
const char* tag(const AnisotropicFriction&) { return "anisotropic_friction"; }
const char* tag(const RateDependentRestitution&) { return "rate_dependent_restitution"; }
const char* tag(const LiquidBridge&) { return "liquid_bridge"; }
const char* tag(const ContactCompliance&) { return "contact_compliance"; }

/// Bodies that are more than a row of numbers.
struct BodyExtra {
  int body = 0;
  Motion motion;
  std::vector<Interval> active;
  std::vector<Yield> yield;  // one or none
};
template <class Io> void fields(Io& io, BodyExtra& x) {
  io("body", x.body);
  io("motion", x.motion);
  io("active", x.active);
  io.if_any("yield", x.yield);
}

struct Description {
  std::vector<Material> materials;
  std::vector<PairLaw> laws;
  std::vector<Shape> shapes;
  std::vector<std::string> names;
  Vec3 gravity = Vec3::Zero();
  std::vector<Effect> effects;
  std::vector<ContactEffect> contact_effects;
  std::vector<BodyExtra> bodies;
};
template <class Io> void fields(Io& io, Description& x) {
  io("materials", x.materials);
  io("laws", x.laws);
  io("shapes", x.shapes);
  io("names", x.names);
  io("gravity", x.gravity);
  io("effects", x.effects);
  io.if_any("contact_effects", x.contact_effects);
  io("bodies", x.bodies);
}

// ---- values to JSON and back ----

class ToJson {
 public:
  template <class T> void operator()(const char* key, const T& value) { out_[key] = convert(value); }
  /// A list that is left out when empty: files of scenes without it stay what they were.
  template <class T> void if_any(const char* key, const std::vector<T>& list) {
    if (!list.empty()) (*this)(key, list);
  }
  Json take() { return std::move(out_); }

  static Json convert(double x) {
    if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
    return x;
  }
  static Json convert(int x) { return x; }
  static Json convert(const std::string& x) { return x; }
  static Json convert(FrictionArm x) { return static_cast<int>(x); }
  static Json convert(const Quat& q) { return Json::array({q.w(), q.x(), q.y(), q.z()}); }
  static Json convert(const std::array<int, 3>& x) { return Json(x); }
  template <int R, int C> static Json convert(const Eigen::Matrix<double, R, C>& m) {
    Json list = Json::array();
    for (Eigen::Index i = 0; i < m.size(); ++i) list.push_back(convert(m(i)));  // column-major, as Eigen counts
    return list;
  }
  template <class T> static Json convert(const std::vector<T>& list) {
    Json out = Json::array();
    for (const T& item : list) out.push_back(convert(item));
    return out;
  }
  template <class... T> static Json convert(const std::variant<T...>& choice) {
    return std::visit([](const auto& x) { return Json{{tag(x), convert(x)}}; }, choice);
  }
  template <class T> static Json convert(const T& record) {
    ToJson inner;
    fields(inner, const_cast<T&>(record));  // `fields` serves both directions; this one only reads
    return inner.take();
  }

 private:
  Json out_ = Json::object();
};

class FromJson {
 public:
  explicit FromJson(const Json& in) : in_(in) {}
  template <class T> void operator()(const char* key, T& value) { convert(in_.at(key), value); }
  template <class T> void if_any(const char* key, std::vector<T>& list) {
    if (in_.contains(key)) (*this)(key, list);
  }

  static void convert(const Json& j, double& x) {
    if (!j.is_string()) {
      j.get_to(x);
      return;
    }
    x = j.get<std::string>() == "inf" ? std::numeric_limits<double>::infinity()
                                      : -std::numeric_limits<double>::infinity();
  }
  static void convert(const Json& j, int& x) { j.get_to(x); }
  static void convert(const Json& j, std::string& x) { j.get_to(x); }
  static void convert(const Json& j, FrictionArm& x) { x = static_cast<FrictionArm>(j.get<int>()); }
  static void convert(const Json& j, Quat& q) {
    q = Quat(j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>(), j.at(3).get<double>());
  }
  static void convert(const Json& j, std::array<int, 3>& x) { j.get_to(x); }
  template <int R, int C> static void convert(const Json& j, Eigen::Matrix<double, R, C>& m) {
    for (Eigen::Index i = 0; i < m.size(); ++i) convert(j.at(static_cast<std::size_t>(i)), m(i));
  }
  template <class T> static void convert(const Json& j, std::vector<T>& list) {
    list.resize(j.size());
    for (std::size_t i = 0; i < list.size(); ++i) convert(j.at(i), list[i]);
  }
  template <class... T> static void convert(const Json& j, std::variant<T...>& choice) {
    const std::string name = j.items().begin().key();
    const bool known = (try_alternative<T>(name, j, choice) || ...);
    if (!known) throw std::out_of_range("unknown kind \"" + name + "\"");
  }
  template <class T> static void convert(const Json& j, T& record) {
    FromJson inner(j);
    fields(inner, record);
  }

 private:
  template <class T, class V> static bool try_alternative(const std::string& name, const Json& j, V& choice) {
    T value;
    if (name != tag(value)) return false;
    convert(j.at(name), value);
    choice = std::move(value);
    return true;
  }
  const Json& in_;
};

}  // namespace

std::string describe_model(const Model& model) {
  Description d{model.materials, model.laws, model.shapes, model.names, model.gravity, model.effects, model.contact_effects, {}};
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    if (body.motion == Motion{} && body.active.empty() && !body.yield) continue;
    d.bodies.push_back({static_cast<int>(i), body.motion, body.active, {}});
    if (body.yield) d.bodies.back().yield.push_back(*body.yield);
  }
  Json json = ToJson::convert(d);
  if (model.periodic.any()) json["periodic"] = ToJson::convert(model.periodic);
  return json.dump();
}

void parse_model_description(const std::string& json, std::size_t body_count, Model& model) {
  Description d;
  const Json text = Json::parse(json);
  FromJson::convert(text, d);
  model.periodic = {};
  if (text.contains("periodic")) FromJson::convert(text.at("periodic"), model.periodic);
  model.materials = std::move(d.materials);
  model.laws = std::move(d.laws);
  model.shapes = std::move(d.shapes);
  model.names = std::move(d.names);
  model.gravity = d.gravity;
  model.effects = std::move(d.effects);
  model.contact_effects = std::move(d.contact_effects);
  model.bodies.assign(body_count, Body{});
  for (BodyExtra& extra : d.bodies) {
    Body& body = model.bodies.at(static_cast<std::size_t>(extra.body));
    body.motion = extra.motion;
    body.active = std::move(extra.active);
    if (!extra.yield.empty()) body.yield = extra.yield.front();
  }
}

}  // namespace repose
