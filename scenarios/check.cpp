/// repose check: reads a scene, says what was understood, and judges whether grains can do it. Runs nothing.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <limits>

#include "backends/backends.hpp"
#include "core/error.hpp"
#include "core/overloaded.hpp"
#include "core/plausibility.hpp"
#include "core/scene_yaml.hpp"
#include "scenarios/command_line.hpp"
#include "scenarios/spreading.hpp"

namespace repose {
namespace {

void print_row(const std::string& block, const std::string& text) { fmt::print("  {:<10} {}\n", block, text); }

std::string law_text(const PairLaw& law) {
  std::string text = fmt::format("friction {:.4g}", law.friction);
  const auto add = [&](const char* name, double value, const char* unit) {
    if (value != 0) text += fmt::format(", {} {:.4g}{}", name, value, unit);
  };
  add("rolling", law.rolling_friction, "");
  add("spinning", law.spinning_friction, "");
  add("rolling arm", law.rolling_friction_length, " m");
  add("spinning arm", law.spinning_friction_length, " m");
  add("restitution", law.restitution, "");
  add("cohesion", law.cohesion, " N");
  add("range", law.cohesion_range, " m");
  return text;
}

std::string kind_of(const Tool& tool) {
  return std::visit(Overloaded{[](const Funnel&) { return "funnel"; }, [](const Base&) { return "base"; },
                               [](const Plate&) { return "plate"; }, [](const Floor&) { return "floor"; },
                               [](const Container&) { return "container"; }, [](const Cup&) { return "cup"; },
                               [](const Roller&) { return "roller"; }, [](const Blade&) { return "blade"; }, [](const Drum&) { return "drum"; }},
                    tool.kind);
}

void print_scene(const Scene& scene) {
  for (const auto& [name, material] : scene.materials)
    print_row("material", fmt::format("{}: {:.4g} kg/m3", name, material.density));
  for (const auto& [names, law] : scene.pairs)
    print_row("pair", fmt::format("{}-{}: {}", names.first, names.second, law_text(law)));
  for (const Tool& tool : scene.tools)
    print_row("tool", fmt::format("{}: {} of {} at ({:.4g}, {:.4g}, {:.4g}) m", tool.name, kind_of(tool), tool.material,
                                  tool.position.x(), tool.position.y(), tool.position.z()));
  for (int axis = 0; axis < 2; ++axis)
    if (scene.periodic.along(axis))
      print_row("periodic", fmt::format("{} from {:.4g} to {:.4g} m", axis == 0 ? "x" : "y", scene.periodic.lower[axis],
                                        scene.periodic.upper[axis]));
  for (const Effect& effect : scene.effects) print_row("effect", effect_name(effect));
  const char* methods[] = {"Gauss-Seidel", "APGD", "Barzilai-Borwein"};
  print_row("solver", fmt::format("{}, {} law, {}, step {:.4g} s, tolerance {:.4g}, at most {} iterations",
                                  methods[static_cast<std::size_t>(scene.solver.kind)],
                                  scene.solver.law == ContactLaw::exact ? "exact" : "relaxed",
                                  scene.solver.integration == Integration::second_order ? "second order" : "symplectic Euler", scene.solver.time_step,
                                  scene.solver.tolerance, scene.solver.max_iterations));
  if (scene.layer) return;  // it has times of its own
  print_row("duration", fmt::format("{:.4g} s, {:.0f} steps, a frame every {:.4g} s", scene.duration,
                                    scene.duration / scene.solver.time_step, scene.frame_interval));
}

void print_layer(const LayerSetup& layer) {
  print_row("layer", fmt::format("{} spreads with {:.4g} m/s to x = {:.4g} m, {:.4g} m above the {}; the bed settles for {:.4g} s at most, step {:.4g} s",
                                 layer.spreader, layer.speed, layer.to, layer.gap, layer.gap_from == LayerSetup::GapFrom::bed ? "bed's mean surface" : "plate",
                                 layer.settle, layer.settle_time_step));
}

void print_model(const Scene& scene, const Model& model) {
  for (const SceneBody& body : scene.bodies) {
    const Body& made = model.bodies[static_cast<std::size_t>(model.find_body(body.name))];
    print_row("body", fmt::format("{}: {} of {}, {}", body.name, scene.shapes.at(body.shape).kind, body.material,
                                  made.dynamic  ? fmt::format("{:.4g} kg", made.mass)
                                  : body.motion ? std::string("driven")
                                                : std::string("fixed")));
  }
  for (const GrainPopulation& population : scene.grains) {
    double smallest = std::numeric_limits<double>::infinity(), largest = 0, mass = 0;
    std::size_t count = 0;
    for (const Body& body : model.bodies) {
      if (body.role != BodyRole::grain || model.names[static_cast<std::size_t>(body.name)] != population.name) continue;
      smallest = std::min(smallest, 2 * body.radius);
      largest = std::max(largest, 2 * body.radius);
      mass += body.mass;
      ++count;
    }
    print_row("grains",
              fmt::format("{}: {} of {}, {} shapes, sizes {:.4g} to {:.4g} m, together {:.4g} kg", population.name,
                          count, population.material, population.mix.size(), smallest, largest, mass));
  }
}

/// Refusals go to stderr, all else to stdout. Returns the number of refusals.
int print_findings(const std::vector<Finding>& findings) {
  int refusals = 0;
  std::fflush(stdout);
  for (const Finding& finding : findings) {
    const bool refused = finding.level == Finding::Level::refusal;
    const char* level = refused ? "refused" : finding.level == Finding::Level::warning ? "warning" : "note";
    fmt::print(refused ? stderr : stdout, "  {:<10} {}: {}\n", level, finding.place, finding.message);
    if (!finding.remedy.empty()) fmt::print(refused ? stderr : stdout, "  {:<10} {}\n", "", finding.remedy);
    refusals += refused ? 1 : 0;
  }
  return refusals;
}

bool has_refusal(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.level == Finding::Level::refusal; });
}

int verdict(int refusals, bool force) {
  if (refusals == 0) {
    fmt::print("The scene is sound.\n");
    return exit_status::done;
  }
  fmt::print(stderr, "repose check: {} refused{}\n",
             refusals == 1 ? "one thing is" : fmt::format("{} things are", refusals),
             force ? "" : "\n  mend the scene; --force lets a run start all the same");
  return force ? exit_status::done : exit_status::input;
}

/// Plausibility, and what the backend lacks. `names`: see KeyNames.
std::vector<Finding> judged(const Scene& scene, const Model& model, const Backend& backend, const Options& options, const KeyNames& names) {
  std::vector<Finding> findings = check_plausibility(scene, &model);
  rename(names, findings);
  for (const std::string& physics : backend.unsupported(model)) {
    const std::string message = fmt::format("backend {} cannot do this", backend.name);
    if (options.allow_unsupported)
      findings.push_back({Finding::Level::warning, physics, message, "the run will leave it out"});
    else
      findings.push_back(
          {Finding::Level::refusal, physics, message, "choose another --backend, or --allow-unsupported"});
  }
  return findings;
}

int check(const Options& options) {
  const Scene scene = load_scene(options.file, options.overrides);
  const Backend& backend = find_backend(options.backend);
  fmt::print("{}\n", options.file.string());
  if (!options.quiet) print_scene(scene);

  // A count of 1e9 must be refused before the grains are made.
  const std::vector<Finding> before = check_before_realising(scene);
  if (has_refusal(before)) return verdict(print_findings(before), options.force);

  const Model model = realise(scene, options.seed);
  if (!options.quiet) print_model(scene, model);
  std::vector<Finding> findings;
  if (!scene.layer) findings = judged(scene, model, backend, options, {});
  if (scene.layer) {  // what `repose layer` makes of it, which puts the spreader where it begins and has times of its own
    if (!options.quiet) print_layer(*scene.layer);
    for (const auto& [made, names] : {std::pair{bed_scene(scene), keys_of_bed()}, {spreading_above_all(scene), keys_of_spreading()}})
      add_missing(judged(made, realise(made, options.seed), backend, options, names), findings);
  }
  return verdict(print_findings(findings), options.force);
}

}  // namespace
}  // namespace repose

int main(int argc, char** argv) {
  repose::CommandInfo info;
  info.name = "check";
  info.summary = "Reads a scene, says what was understood, and tells whether it is plausible. Runs nothing.";
  info.example = "repose check scenarios/configs/block_on_incline.yaml";
  info.file = "SCENE.yaml";
  info.file_required = true;
  return repose::run_command(argc, argv, info, repose::check);
}
