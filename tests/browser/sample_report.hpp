#pragma once
/// A report with every kind of block, for the tests that read it and the browser that opens it.
#include <cmath>
#include <limits>
#include <string>

#include "analysis/report/report.hpp"

namespace repose::report {

/// `png`: the picture to show; empty: no picture.
inline Report sample_report(const std::string& png = "") {
  Report report;
  report.title = "Sample <report>";
  report.subtitle = "Every kind of block, µ = 0.52 & ρ = 0.05";
  report.headlines = {{"Angle of repose", 32.934, 1.151, "°", "standard deviation over azimuths and flanks"},
                      {"Solid fraction", 0.4512, 0.0031, "", ""},
                      {"Discharge rate", 2.31e-5, {}, "kg/s", ""}};

  Section heap{"The heap", {Warnings{{"3 of 12,000 steps did not converge.", "A <warning> with \"quotes\"."}}}};
  if (!png.empty()) heap.blocks.push_back(Picture{png, "The heap at rest.", "A heap of grains of seven shapes"});
  heap.blocks.push_back(Text{"A first paragraph.\n\nA second one."});
  report.sections.push_back(heap);

  Chart profile{
      "Radial profile", "Mean over azimuths.", {"Radius", "mm", false}, {"Height", "mm", false}, {}, {}, true};
  Series mean{"mean", {}, {}, {}, Series::Style::line_and_points, false};
  for (int i = 0; i < 26; ++i) {
    const double r = 0.05 * i;
    mean.x.push_back(r);
    mean.y.push_back(0.648 * (1.3 - r) + 0.008 * std::sin(9.0 * i));
    mean.error.push_back(0.02);
  }
  profile.series = {mean, {"fit", {0.2, 1.1}, {0.713, 0.130}, {}, Series::Style::line, true}};

  Chart solver{"Solver convergence",     "",   {"Time", "s", false}, {"Residual", "", true}, {},
               {{"tolerance", 1e-3, 0}}, false};
  Series residual{"residual", {}, {}, {}, Series::Style::line, false};
  for (int i = 0; i < 12000; ++i) {
    residual.x.push_back(5e-5 * i);
    residual.y.push_back(i % 1000 == 5 ? 0 : 1e-3 * std::exp(-2 * std::abs(std::sin(1.7 * i))));
  }
  residual.y[6000] = std::numeric_limits<double>::quiet_NaN();
  solver.series = {residual};

  Chart table2{"Angle against rolling friction",          "",   {"ρ = σ", "1", false}, {"Angle", "°", false}, {},
               {{"measured 32.93 ± 1.15°", 32.93, 1.15}}, false};
  table2.series = {
      {"published", {0.05, 0.075, 0.09, 0.1}, {31.12, 32.72, 33.65, 34.97}, {}, Series::Style::line_and_points, true},
      {"simulated",
       {0.05, 0.075, 0.09, 0.1},
       {30.8, 32.1, 33.2, 34.1},
       {0.4, 0.5, 0.4, 0.45},
       Series::Style::points,
       false}};
  report.sections.push_back({"Charts", {profile, solver, table2}});

  report.sections.push_back({"Numbers",
                             {Table{"Table 2",
                                    {"ρ = σ", "published [°]", "remark"},
                                    {{"0.05", "31.12", "<b>"}, {"0.1", "34.97", ""}},
                                    {"A note."}},
                              Settings{"Settings", {{"time step", "50 µs"}, {"law", "exact"}}},
                              Listing{"The resolved scene", "materials:\n  pa12: {density: 1020}\n"}}});
  return report;
}

}  // namespace repose::report
