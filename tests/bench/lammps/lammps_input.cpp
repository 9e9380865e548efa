#include "tests/bench/lammps/lammps_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/atomic_file.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

constexpr double poisson = 0.3;
constexpr int frames = 20;  // of the spreading, for its overlaps

struct Mean {
  double radius = 0, mass = 0;
};

Mean mean_grain(const Model& model) {
  Mean mean;
  for (const Body& body : model.bodies)
    if (body.role == BodyRole::grain) {
      mean.radius += body.radius;
      mean.mass += body.mass;
    }
  const double n = static_cast<double>(model.grain_count());
  return {mean.radius / n, mean.mass / n};
}

void demand(bool good, const std::string& what) {
  if (!good) throw Error("LAMMPS", what, "take a scene of spheres, plates and a roller with periodic sides, such as layer-quick.yaml");
}

/// The contact of two materials in the words of `pair_style granular` and `fix wall/gran`. `reduced`: R* of a typical pair [m].
std::string contact(const PairLaw& law, double young, double reduced, double reduced_mass) {
  demand(law.friction_arm == FrictionArm::reduced_radius && law.rolling_friction_length == 0, "an arm other than R* is not known there");
  demand(law.cohesion == 0, "cohesion is another law there");
  // Stiffness and critical damping of a contact that overlaps by a hundredth of a diameter.
  const double overlap = 0.02 * 2 * reduced;
  const double stiffness = young / (1 - poisson * poisson) * std::sqrt(reduced * overlap);
  const double damping = 2 * std::sqrt(stiffness * reduced_mass);
  std::string text = fmt::format("hertz/material {:.6g} {:.6g} {:.6g} tangential mindlin NULL 1.0 {:.6g} damping tsuji", young, law.restitution,
                                 poisson, law.friction);
  if (law.rolling_friction > 0)
    text += fmt::format(" rolling sds {:.6g} {:.6g} {:.6g}", stiffness, damping, law.rolling_friction);
  if (law.spinning_friction > 0)
    text += fmt::format(" twisting sds {:.6g} {:.6g} {:.6g}", stiffness * reduced * reduced, damping * reduced * reduced,
                        law.spinning_friction * reduced);
  return text;
}

std::string bed_data(const Model& model) {
  Vec3 lower = Vec3::Constant(1e300), upper = Vec3::Constant(-1e300);
  std::string atoms, velocities;
  std::size_t id = 0;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    if (body.role != BodyRole::grain) continue;
    const Shape& shape = model.shapes[static_cast<std::size_t>(body.shape)];
    demand(shape.parts.size() == 1 && std::holds_alternative<Sphere>(shape.parts.front().primitive), "a grain is not a sphere");
    const Vec3 &x = model.initial.position[i], &v = model.initial.velocity[i], &w = model.initial.angular_velocity[i];
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
    ++id;
    atoms += fmt::format("{} 1 {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", id, 2 * body.radius, body.mass / body.volume, x.x(), x.y(), x.z());
    velocities += fmt::format("{} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", id, v.x(), v.y(), v.z(), w.x(), w.y(), w.z());
  }
  const double room = 0.3 * (upper.x() - lower.x());
  return fmt::format("Settled bed\n\n{} atoms\n1 atom types\n\n{:.9g} {:.9g} xlo xhi\n{:.17g} {:.17g} ylo yhi\n{:.9g} {:.9g} zlo zhi\n\n"
                     "Atoms # sphere\n\n{}\nVelocities\n\n{}",
                     id, lower.x() - room, upper.x() + room, model.periodic.lower.y(), model.periodic.upper.y(), lower.z() - room,
                     upper.z() + room, atoms, velocities);
}

}  // namespace

double rayleigh_step(const Model& model, double young, double share) {
  double smallest = 1e300, density = 0;
  for (const Body& body : model.bodies)
    if (body.role == BodyRole::grain) {
      smallest = std::min(smallest, body.radius);
      density = body.mass / body.volume;
    }
  const double shear = young / (2 * (1 + poisson));
  return share * std::numbers::pi * smallest * std::sqrt(density / shear) / (0.1631 * poisson + 0.8766);
}

void write_lammps_input(const Scene& scene, const Spreading& spreading, const LammpsSettings& settings) {
  const Model& model = spreading.prepared.model;
  const LayerSetup& layer = *scene.layer;
  demand(model.periodic.along(1) && !model.periodic.along(0), "the sides must be periodic along y");
  demand(model.effects.empty() && model.contact_effects.empty(), "effects are not known there");
  const Mean mean = mean_grain(model);
  std::map<std::string, int> material_of;
  for (std::size_t k = 0; k < model.materials.size(); ++k) material_of[model.materials[k].name] = static_cast<int>(k);
  const int grain = std::find_if(model.bodies.begin(), model.bodies.end(), [](const Body& b) { return b.role == BodyRole::grain; })->material;

  std::string walls, roller;
  for (const Tool& tool : spreading.prepared.scene.tools) {
    const std::string law = contact(model.law(grain, material_of.at(tool.material)), settings.young, mean.radius, mean.mass);
    const Vec3& p = tool.position;
    std::string region;
    if (const auto* plate = std::get_if<Plate>(&tool.kind)) {
      const Vec3& s = plate->size;
      region = fmt::format("region {} block {:.9g} {:.9g} -1 1 {:.9g} {:.9g} side out units box\n", tool.name, p.x() - s.x() / 2, p.x() + s.x() / 2,
                           p.z() - s.z(), p.z());
    } else if (const auto* cylinder = std::get_if<Roller>(&tool.kind)) {
      const double turn = tool.motion.angular_velocity.y();
      demand(turn == 0, "a roller that turns is not written");
      region = fmt::format("region {} cylinder y {:.9g} {:.9g} {:.9g} -1 1 side out units box move v_x NULL NULL\n", tool.name, p.x(), p.z(),
                           cylinder->diameter / 2);
    } else {
      demand(false, "a tool is neither a plate nor a roller");
    }
    walls += region + fmt::format("fix wall_{} all wall/gran/region granular {} region {}\n", tool.name, law, tool.name);
  }

  const auto steps = [&](double time) { return static_cast<long>(std::lround(time / settings.time_step)); };
  const std::string common = fmt::format(
      "units si\natom_style sphere\nboundary f p f\nnewton off\ncomm_modify vel yes\nneighbor {:.6g} bin\n"
      "neigh_modify every 1 delay 0 check yes\n{{}}\n"
      "pair_style granular\npair_coeff * * {}\n"
      "# The way of the roller: none before `start`, to its end, and none after.\n"
      "variable start equal {}\nvariable t equal \"(step - v_start)*dt\"\n"
      "variable x equal \"{:.9g}*((v_t > 0)*(v_t < {:.9g})*v_t + (v_t >= {:.9g})*{:.9g})\"\n{}"
      "fix gravity all gravity {:.9g} vector 0 0 -1\nfix motion all nve/sphere\ntimestep {:.9g}\n"
      "thermo 2000\nthermo_modify lost warn\n",
      0.4 * mean.radius, contact(model.law(grain, grain), settings.young, mean.radius / 2, mean.mass / 2), steps(settings.settle), layer.speed,
      spreading.path.duration, spreading.path.duration, spreading.path.duration, walls, model.gravity.norm(), settings.time_step);
  const std::string columns = "id x y z vx vy vz";
  const std::string sorted = "dump_modify d sort id format float %.12g\n";
  const long spreading_steps = steps(spreading.prepared.scene.duration);
  std::filesystem::create_directories(settings.folder);
  write_atomically(settings.folder / "bed.data", bed_data(model));
  write_atomically(settings.folder / "settle.in",
                   fmt::format(fmt::runtime(common), "read_data bed.data") +
                       fmt::format("run {}\nwrite_restart settled.restart\nwrite_dump all custom settled.dump {} modify sort id format float %.12g\n",
                                   steps(settings.settle), columns));
  std::string spread = fmt::format(fmt::runtime(common), "read_restart settled.restart");
  spread += fmt::format("dump d all custom {} spread.dump {}\n{}run {}\nwrite_dump all custom final.dump {} modify sort id format float %.12g\n",
                        std::max(1L, spreading_steps / frames), columns, sorted, spreading_steps, columns);
  write_atomically(settings.folder / "spread.in", spread);
}

}  // namespace repose
