/// repose run SCENE.yaml: simulates any scene.
#include <fmt/format.h>

#include "scenarios/simulate.hpp"

namespace {

int run_scene(const repose::Options& options) {
  const repose::Prepared prepared = repose::prepare(options.file, options);
  const repose::RunReport report = repose::simulate(prepared, options);
  const int status = repose::report_status(report, options);
  if (report.end == repose::RunReport::End::interrupted) return status;
  repose::write_result(options.out / "result.json", repose::common_result("run", prepared, options, report));
  fmt::print(
      "{} steps, {:.6g} s simulated in {:.1f} s; {:.4g} contacts and {:.3g} iterations on average; largest residual {:.2g}\n"
      "{}\n",
      report.steps, report.final_state.time, report.wall_s, report.contacts_mean, report.iterations_mean, report.residual_max,
      (options.out / "result.json").string());
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  repose::CommandInfo info;
  info.name = "run";
  info.summary = "Simulates a scene; writes run.h5 (frames, model, solver log), run.xmf for ParaView, and result.json.";
  info.example = "repose run scenarios/configs/block_on_incline.yaml --set duration=0.5 --out out/block";
  info.file = "SCENE.yaml";
  info.file_required = true;
  return repose::run_command(argc, argv, info, run_scene);
}
