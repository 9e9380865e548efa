#include "scenarios/heap_json.hpp"

namespace repose {
namespace {

using nlohmann::json;

json angle_json(const ReposeMeasurement& repose) {
  if (!repose.angle) return {{"value", nullptr}, {"sd", nullptr}, {"unit", "deg"}, {"message", repose.message}};
  const ReposeAngle& a = *repose.angle;
  json flanks = json::array();
  for (const Flank& f : a.flanks)
    flanks.push_back({{"azimuth_deg", f.azimuth_deg}, {"angle_deg", f.angle_deg}, {"upper_deg", f.upper_deg},
                      {"lower_deg", f.lower_deg}, {"rms_diameters", f.rms}});
  return {{"value", a.value},
          {"sd", a.sd},
          {"se", a.se},
          {"unit", "deg"},
          {"concavity_deg", a.concavity},
          {"rms_diameters", a.rms},
          {"whole_depth_deg", a.whole_depth},
          {"radial_deg", a.radial},
          {"radial_se_deg", a.radial_se},
          {"foot", a.foot},
          {"apex", a.apex},
          {"flanks", flanks}};
}

json rest_json(const RestReport& rest, const std::optional<Displacement>& moved) {
  json result = {{"at_rest", rest.at_rest},       {"reason", rest.reason},       {"speed_scale", rest.speed_scale},
                 {"speed_max", rest.speed_max},   {"speed_rms", rest.speed_rms}, {"falling", rest.falling},
                 {"in_funnel", rest.in_funnel}};
  if (moved)
    result["displacement"] = {{"interval", moved->interval}, {"max_diameters", moved->max}, {"rms_diameters", moved->rms}};
  return result;
}

}  // namespace

json heap_json(const HeapMeasurement& heap) {
  const HeapGrains& grains = heap.repose.grains;
  const RadialProfile& profile = heap.repose.profile;
  json result;
  result["angle_of_repose"] = angle_json(heap.repose);
  result["solid_fraction"] = heap.solid ? json(heap.solid->value) : json(nullptr);
  if (heap.solid)
    result["solid_fraction_detail"] = {{"sd", heap.solid->sd}, {"se", heap.solid->se}, {"volume", heap.solid->volume}};
  result["discharge_rate"] = heap.rate ? json(heap.rate->rate) : json(nullptr);
  result["discharge"] = {{"time", heap.discharge.time}, {"mass", heap.discharge.mass}};
  if (heap.rate)
    result["discharge"].update({{"rate_se", heap.rate->se}, {"from", heap.rate->from}, {"to", heap.rate->to},
                                {"discharged", heap.rate->discharged}});
  if (heap.beverloo) result["discharge"]["beverloo"] = *heap.beverloo;
  result["heap"] = {{"grains_on_base", grains.heap.size()},
                    {"grains_in_trench", grains.trench.size()},
                    {"grains_on_rim", grains.rim.size()},
                    {"grains_loose", grains.loose.size()},
                    {"mass", grains.heap_mass},
                    {"trench_mass", grains.trench_mass},
                    {"volume", heap.volume},
                    {"mean_diameter", grains.diameter},
                    {"coverage", profile.coverage},
                    {"covers_base", profile.covers_base}};
  result["rest"] = rest_json(heap.rest, heap.moved);
  result["profile"] = {{"radius", profile.radius}, {"height", profile.height}, {"sd", profile.sd}};
  return result;
}

}  // namespace repose
