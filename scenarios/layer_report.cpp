#include "scenarios/layer_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/render/camera.hpp"
#include "analysis/render/render.hpp"
#include "scenarios/version.hpp"

namespace repose {
namespace {

using namespace report;

constexpr double um = 1e6, mm = 1e3;
const std::string dash = "–";  // not known

/// The bed with the spreader over the middle of the region, from the frame nearest to that time.
std::optional<Picture> bed_picture(const LayerReportInput& in) {
  const LayerSetup& setup = *in.prepared.scene.layer;
  if (in.recording.frames.empty()) return std::nullopt;
  const double middle = 0.5 * (setup.lower.x() + setup.upper.x());
  const auto x_at = [&](const Snapshot& s) { return in.path.from + setup.speed * s.time; };
  const Snapshot& frame = *std::min_element(in.recording.frames.begin(), in.recording.frames.end(), [&](const Snapshot& a, const Snapshot& b) {
    return std::abs(x_at(a) - middle) < std::abs(x_at(b) - middle);
  });
  RenderOptions options;
  options.threads = in.options.threads;
  options.hide = {"side_left", "side_right"};
  options.by_population = true;  // where the grains of the pile go
  options.caption = fmt::format("t = {:.4f} s, lowest line of the spreader at x = {:.2f} mm", frame.time, x_at(frame) * mm);
  FrameOptions view;
  view.hide = options.hide;
  view.hide.push_back(setup.spreader);
  const Camera camera = frame_scene(in.prepared.model, frame, view);
  return Picture{encode_png(render(in.prepared.model, frame, camera, options)),
                 "The bed and the spreader under way; side walls are not drawn, the spreader is glass where it hides the powder.", ""};
}

Chart profile_chart(const LayerReportInput& in) {
  Chart chart;
  const HeightGrid &b = in.layer.before.surface, &a = in.layer.after.surface;
  const int row = a.ny / 2;
  chart.title = "Profile along the travel";
  chart.caption = fmt::format("Height of the surface along the line y = {:.3f} mm, before and after; 0 is the plate.",
                              a.middle(0, row).y() * mm);
  chart.x = {"x", "mm"};
  chart.y = {"height above the plate", "µm"};
  for (const auto& [name, grid] : {std::pair{"before", &b}, {"after", &a}}) {
    Series s{name, {}, {}, {}, Series::Style::line, false};
    for (int i = 0; i < grid->nx; ++i) {
      s.x.push_back(grid->middle(i, row).x() * mm);
      s.y.push_back(grid->at(i, row) * um);
    }
    chart.series.push_back(std::move(s));
  }
  chart.bands.push_back({"lowest line of the spreader", (in.path.lowest - in.prepared.scene.layer->plate) * um, 0});
  return chart;
}

/// Shares of all places; NaN: none of a height.
Series histogram(const char* name, const std::vector<double>& heights, double low, double high, bool dashed) {
  constexpr int bins = 60;
  std::vector<double> count(bins, 0);
  const double n = static_cast<double>(heights.size());
  for (double z : heights) {
    if (std::isnan(z)) continue;
    count[static_cast<std::size_t>(std::clamp(static_cast<int>((z - low) / (high - low) * bins), 0, bins - 1))] += 1;
  }
  Series s{name, {}, {}, {}, Series::Style::line, dashed};
  for (int k = 0; k < bins; ++k) {
    s.x.push_back((low + (k + 0.5) * (high - low) / bins) * um);
    s.y.push_back(n > 0 ? 100 * count[static_cast<std::size_t>(k)] / n : 0);
  }
  return s;
}

Chart histogram_chart(const char* title, const char* caption, const std::vector<double>& before, const std::vector<double>& after) {
  Chart chart;
  chart.title = title;
  chart.caption = caption;
  chart.x = {"height above the plate", "µm"};
  chart.y = {"share", "%"};
  std::vector<double> all = before;
  all.insert(all.end(), after.begin(), after.end());
  const HeightFigures f = height_figures(all);
  const double high = f.max > f.min ? f.max : f.min + 1e-6;
  chart.series = {histogram("before", before, f.min, high, true), histogram("after", after, f.min, high, false)};
  return chart;
}

Chart depth_chart(const LayerMeasurement& m) {
  Chart chart;
  chart.title = "Packing by height";
  chart.caption = "Share of each slab that is solid, and, dashed, the share of it that lies below the surface, from exact chords through the grains.";
  chart.x = {"height above the plate", "µm"};
  chart.y = {"share", "1"};
  for (const auto& [name, p] : {std::pair{"before", &m.before.packing}, {"after", &m.after.packing}}) {
    Series solid{name, {}, {}, {}, Series::Style::line, false}, below{std::string(name) + ", below the surface", {}, {}, {}, Series::Style::line, true};
    for (std::size_t k = 0; k < p->solid.size(); ++k)
      for (auto [series, share] : {std::pair{&solid, p->solid[k]}, {&below, p->below_surface[k]}}) {
        series->x.push_back((static_cast<double>(k) + 0.5) * p->slab * um);
        series->y.push_back(share);
      }
    chart.series.push_back(std::move(solid));
    chart.series.push_back(std::move(below));
  }
  return chart;
}

Chart segregation_chart(const char* title, const char* axis, double scale, const char* unit, const std::vector<SegregationBin>& before,
                        const std::vector<SegregationBin>& after) {
  Chart chart;
  chart.title = title;
  chart.caption = "Mean diameter of the grains whose centre lies in the bin; bars: standard error.";
  chart.x = {axis, unit};
  chart.y = {"mean diameter", "µm"};
  for (const auto& [name, bins] : {std::pair{"before", &before}, {"after", &after}}) {
    Series s{name, {}, {}, {}, Series::Style::line_and_points, false};
    for (const SegregationBin& b : *bins) {
      s.x.push_back(0.5 * (b.from + b.to) * scale);
      s.y.push_back(b.size * um);
      s.error.push_back(b.size_se * um);
    }
    chart.series.push_back(std::move(s));
  }
  return chart;
}

/// Shares of the shapes: only where there are several.
void add_shape_charts(const Segregation& before, const Segregation& after, std::vector<Block>& blocks) {
  constexpr std::size_t colours = 6;  // of a chart; what comes after is dashed
  if (after.kinds.size() < 2) return;
  const auto add = [&](const char* title, const char* axis, double scale, const char* unit, const std::vector<SegregationBin>& bins) {
    Chart chart;
    chart.title = title;
    chart.caption = "Share by number of each shape among the grains whose centre lies in the bin; bars: binomial standard error.";
    chart.x = {axis, unit};
    chart.y = {"share", "%"};
    chart.low = true;
    for (std::size_t k = 0; k < after.kinds.size(); ++k) {
      Series s{after.kinds[k], {}, {}, {}, Series::Style::line_and_points, k >= colours};
      for (const SegregationBin& b : bins) {
        const bool some = b.grains > 0;
        s.x.push_back(0.5 * (b.from + b.to) * scale);
        s.y.push_back(some ? 100 * b.share[k] : std::numeric_limits<double>::quiet_NaN());
        s.error.push_back(some ? 100 * b.share_se[k] : std::numeric_limits<double>::quiet_NaN());
      }
      chart.series.push_back(std::move(s));
    }
    blocks.push_back(std::move(chart));
  };
  add("Shapes by height, before", "height above the plate", um, "µm", before.by_height);
  add("Shapes by height, after", "height above the plate", um, "µm", after.by_height);
  add("Shapes along the travel, before", "x", mm, "mm", before.by_x);
  add("Shapes along the travel, after", "x", mm, "mm", after.by_x);
}

/// x of the lowest line [mm].
double place_of(const LayerReportInput& in, double time) {
  return (in.path.from + in.prepared.scene.layer->speed * std::min(time, in.path.duration)) * mm;
}

std::string torque_refers_to(const LayerReportInput& in) {
  const bool roller = std::holds_alternative<Roller>(spreader_of(in.prepared.scene).kind);
  return roller ? "About the middle of the roller's axis." : "About the centre of the blade's body, which travels with it.";
}

Chart load_chart(const LayerReportInput& in, bool torque) {
  Chart chart;
  chart.title = torque ? "Torque on the spreader" : "Force on the spreader";
  chart.caption = "From the contact forces of each step; gaps: steps that did not converge or in which grains overlapped. Lengthwise the place of the lowest line.";
  if (torque) chart.caption += " " + torque_refers_to(in);
  chart.x = {"x of the lowest line", "mm"};
  chart.y = {torque ? "torque about y" : "force", torque ? "nN m" : "µN"};
  Series x{"x, along the travel", {}, {}, {}, Series::Style::line, false}, z{"z, upward", {}, {}, {}, Series::Style::line, false};
  const std::vector<bool> tells = steps_that_tell(in.recording.steps, in.layer.load.overlap_allowed);
  for (std::size_t k = 0; k < tells.size(); ++k) {
    const StepRecord& step = in.recording.steps[k];
    const double at = place_of(in, step.time);
    const double none = std::numeric_limits<double>::quiet_NaN();
    x.x.push_back(at);
    z.x.push_back(at);
    x.y.push_back(!tells[k] ? none : torque ? step.tool_torque.y() * 1e9 : step.tool_force.x() * 1e6);
    z.y.push_back(!tells[k] ? none : step.tool_force.z() * 1e6);
  }
  if (torque) {
    x.name = "torque about y";
    chart.series = {x};
  } else {
    chart.series = {x, z};
  }
  return chart;
}

Chart rise_chart(const LayerReportInput& in) {
  Chart chart;
  chart.title = "Rise of the spreader";
  chart.caption = "Height above its stops. Lengthwise the place of the lowest line.";
  chart.x = {"x of the lowest line", "mm"};
  chart.y = {"rise", "µm"};
  Series rise{"rise", {}, {}, {}, Series::Style::line, false};
  for (const StepRecord& step : in.recording.steps) {
    rise.x.push_back(place_of(in, step.time));
    rise.y.push_back(step.tool_rise * um);
  }
  chart.series = {rise};
  return chart;
}

Chart step_chart(const LayerReportInput& in, bool residual) {
  Chart chart;
  chart.title = residual ? "Residual of each step" : "Iterations of each step";
  chart.x = {"time", "s"};
  chart.y = {residual ? "residual" : "iterations", "", residual};
  Series s{chart.y.label, {}, {}, {}, Series::Style::line, false};
  for (const StepRecord& step : in.recording.steps) {
    s.x.push_back(step.time);
    s.y.push_back(residual ? step.report.residual : step.report.iterations);
  }
  chart.series = {s};
  if (residual) chart.bands.push_back({"tolerance", in.prepared.scene.solver.tolerance, 0});
  return chart;
}

std::string filters_in_words(const LayerSetup& setup) {
  std::string words;
  if (setup.s_filter > 0) words += fmt::format(", Gaussian S filter of {:g} µm", setup.s_filter * um);
  if (setup.l_filter > 0) words += fmt::format(", Gaussian L filter of {:g} µm", setup.l_filter * um);
  return words.empty() ? ", no other filter" : words;
}

Table surface_table(const LayerMeasurement& m, const LayerSetup& setup) {
  Table t;
  t.title = "Surface";
  t.header = {"µm", "before", "after"};
  using Known = std::optional<double>;
  const auto row = [&](const char* name, Known before, Known after, double unit = um) {
    const auto cell = [&](Known value) { return value ? fmt::format("{:.2f}", *value * unit) : dash; };
    t.rows.push_back({name, cell(before), cell(after)});
  };
  const auto with = [&](const char* name, Known before, Known after, auto error, double unit = um) {
    const auto cell = [&](Known value, const BedSurface& s) {
      if (!value) return dash;
      const Known se = s.error ? Known((*s.error).*error) : std::nullopt;
      return se && *se > 0 ? rounded(*value * unit, *se * unit) : fmt::format("{:.2f}", *value * unit);
    };
    t.rows.push_back({name, cell(before, m.before), cell(after, m.after)});
  };
  const Roughness &a = m.before.roughness, &b = m.after.roughness;
  with("mean height", m.before.heights.mean, m.after.heights.mean, &RoughnessError::mean);
  row("lowest", m.before.heights.min, m.after.heights.min);
  row("highest", m.before.heights.max, m.after.heights.max);
  row("standard deviation", m.before.heights.sd, m.after.heights.sd);
  with("Sa", a.Sa, b.Sa, &RoughnessError::Sa);
  with("Sq", a.Sq, b.Sq, &RoughnessError::Sq);
  row("Sp", a.Sp, b.Sp);
  row("Sv", a.Sv, b.Sv);
  row("Sz", a.Sz, b.Sz);
  with("Ssk [1]", a.Ssk, b.Ssk, &RoughnessError::Ssk, 1);
  with("Sku [1]", a.Sku, b.Sku, &RoughnessError::Sku, 1);
  row("Sal", m.before.Sal, m.after.Sal);
  row("covered by grains [%]", m.before.coverage, m.after.coverage, 100);
  t.notes = {fmt::format("ISO 25178-2, least-squares plane removed{}; uncertainties: block bootstrap over the region. Extremes depend on the area. Where no grain stands the surface is the plate, height 0.{}", filters_in_words(setup),
                         m.before.Sal && m.after.Sal ? "" : " –: not defined (a flat surface), or not found (correlated beyond half the region)")};
  return t;
}

Table highest_table(const LayerMeasurement& m) {
  Table t;
  t.title = fmt::format("Highest grain in each square of {:.0f} µm", m.after.highest.square * um);
  t.header = {"µm", "centres before", "centres after", "tops before", "tops after"};
  const SquareFigures &before = m.before.squares.front(), &after = m.after.squares.front();
  const HeightFigures* columns[] = {&before.centres, &after.centres, &before.tops, &after.tops};
  const auto row = [&](const std::string& name, auto value) {
    std::vector<std::string> cells{name};
    for (const HeightFigures* f : columns) cells.push_back(f->n > 0 ? fmt::format("{:.2f}", value(*f) * um) : dash);
    t.rows.push_back(std::move(cells));
  };
  row("mean", [](const HeightFigures& f) { return f.mean; });
  row("lowest", [](const HeightFigures& f) { return f.min; });
  row("highest", [](const HeightFigures& f) { return f.max; });
  row("standard deviation", [](const HeightFigures& f) { return f.sd; });
  for (std::size_t k = 0; k < told_shares.size(); ++k)
    row(fmt::format("{:g} %", 100 * told_shares[k]), [k](const HeightFigures& f) { return f.quantile[k]; });
  t.notes = {fmt::format("Of {} squares {} have the top of a grain before and {} after. A square without is left out, not taken for bare plate: a grain of the next may cover it.",
                         m.after.highest.top.size(), before.tops.n, after.tops.n)};
  return t;
}

/// How much the figures depend on the size of the squares, of which Table 3 of the study tells nothing.
Table squares_table(const LayerMeasurement& m) {
  Table t;
  t.title = "Highest grains by the size of the squares";
  t.header = {"squares [µm]", "of", "n", "before: min", "max", "sd", "after: min", "max", "sd", "sd ratio"};
  for (std::size_t k = 0; k < m.after.squares.size(); ++k)
    for (const auto& [name, of] : {std::pair{"centres", &SquareFigures::centres}, {"tops", &SquareFigures::tops}}) {
      const HeightFigures &before = m.before.squares[k].*of, &after = m.after.squares[k].*of;
      std::vector<std::string> cells{fmt::format("{:.0f}", m.after.squares[k].square * um), name};
      cells.push_back(before.n == after.n ? fmt::format("{}", after.n) : fmt::format("{}, {}", before.n, after.n));
      for (const HeightFigures* f : {&before, &after})
        for (const double value : {f->min, f->max, f->sd}) cells.push_back(f->n > 0 ? fmt::format("{:.1f}", value * um) : dash);
      cells.push_back(before.n > 0 && after.n > 0 && before.sd > 0 ? fmt::format("{:.2f}", after.sd / before.sd) : dash);
      t.rows.push_back(std::move(cells));
    }
  t.notes = {"Heights in µm; n: squares counted; sd ratio: after over before. The highest grain of a larger square is chosen from more grains: it is higher, and scatters less. Extremes depend on the area, which is that of whole squares: of large ones somewhat less fits into the region."};
  return t;
}

Table bed_table(const LayerReportInput& in) {
  const LayerMeasurement& m = in.layer;
  Table t;
  t.title = "Bed and spreader";
  t.header = {"quantity", "value", "unit", "remark"};
  const auto row = [&](std::string a, std::string b, std::string c, std::string d) {
    t.rows.push_back({std::move(a), std::move(b), std::move(c), std::move(d)});
  };
  const auto with_error = [](double value, std::optional<double> se) { return se ? rounded(value, se) : rounded(value) + " ± " + dash; };
  const auto packing = [&](const Packing& p) { return p.fraction ? with_error(*p.fraction, p.se) : dash; };
  const auto pores = [](const Packing& p) { return p.pores > 0 ? fmt::format("{:.1f}", p.pore_mean * um) : dash; };
  row("layer thickness, mean", with_error(m.thickness.mean * um, m.thickness_se ? std::optional(*m.thickness_se * um) : std::nullopt), "µm",
      "after minus before, cell by cell; block bootstrap of the difference");
  row("layer thickness, 5 % to 95 %", fmt::format("{:.1f} to {:.1f}", m.thickness.quantile[2] * um, m.thickness.quantile[6] * um), "µm", "");
  row("packing fraction before", packing(m.before.packing), "1", "solid share between plate and surface");
  row("packing fraction after", packing(m.after.packing), "1", "");
  row("solid volume that came", fmt::format("{:.2f}", m.solid_per_area * um), "µm", "per area; may exceed the thickness, for the spreader compacts the bed below");
  row("solid volume that came, of the gap", m.solid_of_gap ? rounded(*m.solid_of_gap) : dash, "1",
      "of the gap between the mean surface before and the spreader: how densely a single layer lies, which its packing fraction does not tell");
  row("pores, mean upright chord", fmt::format("{} → {}", pores(m.before.packing), pores(m.after.packing)), "µm", "before → after");
  row("mass in the region", fmt::format("{:.4g} → {:.4g}", m.mass_in_region_before * 1e9, m.mass_in_region_after * 1e9), "µg",
      fmt::format("of {:.4g} µg in all", m.mass * 1e9));
  row("grains that came into the region", fmt::format("{}", m.moved_in), "", "");
  const SpreaderLoad& l = m.load;
  const auto load = [&](const Vec3& mean, const std::optional<Vec3>& se, int axis, double unit) {
    if (l.used == 0) return dash;
    return with_error(mean[axis] * unit, se ? std::optional<double>((*se)[axis] * unit) : std::nullopt);
  };
  row("force along the travel", load(l.force, l.force_se, 0, um), "µN", "mean over the region, standard error from ten stretches");
  row("force upward", load(l.force, l.force_se, 2, um), "µN", "");
  const bool yields = spreader_of(in.prepared.scene).yield.has_value();
  if (yields)
    row("rise of the spreader", fmt::format("{:.3g}, at most {:.3g}", l.rise * um, l.rise_largest * um), "µm", "above its stops, mean over the region");
  row("torque about y", load(l.torque, l.torque_se, 1, 1e9), "nN m", torque_refers_to(in));
  row("steps that converged", fmt::format("{} of {}", l.converged, l.steps), "", fmt::format("over the region; largest residual {:.2g}", l.residual_max));
  row("steps that tell the force", fmt::format("{} of {}", l.used, l.steps), "",
      fmt::format("converged, and no grains overlapped deeper than {:.2g} µm, a hundredth of a mean diameter; deepest {:.2g} µm", l.overlap_allowed * um, l.overlap_max * um));
  row("deepest penetration", fmt::format("{:.3g}", in.run.max_penetration * um), "µm", "over all steps, by geometry");
  row("contacts", fmt::format("{:.0f}", in.run.contacts_mean), "", "mean");
  row("iterations per step", fmt::format("{:.1f}", in.run.iterations_mean), "", "mean");
  if (yields)
    t.notes = {"The spreader gives way upward where the powder pushes harder than its load: forces above the load accelerate its mass."};
  else
    t.notes = {"Rigid grains under a rigid spreader of prescribed path can jam: single peaks of the force then depend on the time step; means are "
               "told, from steps that tell the force only. Whether they are converged in the time step shows a second run with half of it (`--half-step`). A "
               "spreader that yields (`yield` of its tool) has no such peaks."};
  return t;
}

std::vector<double> as_doubles(const HeightGrid& g) { return {g.height.begin(), g.height.end()}; }

std::vector<double> without_nan(std::vector<double> heights) {
  std::erase_if(heights, [](double z) { return std::isnan(z); });
  return heights;
}

/// "bare plate", "grains over 71 % of the plate"; empty where they cover all of it.
std::string cover_in_words(const BedSurface& s) {
  if (s.coverage == 0) return "bare plate";
  return s.coverage < 1 ? fmt::format("grains over {:.1f} % of the plate", 100 * s.coverage) : "";
}

/// "before 12.34 µm", and how much of the plate was seen then.
std::string before_in_words(const LayerMeasurement& m, const std::string& value) {
  if (m.before.coverage == 0) return "before: bare plate";
  const std::string cover = cover_in_words(m.before);
  return "before " + value + (cover.empty() ? "" : ", " + cover);
}

std::vector<Headline> headlines_of(const LayerMeasurement& m) {
  const std::string cover = cover_in_words(m.after);
  std::vector<Headline> list;
  list.push_back({"Sa after", m.after.roughness.Sa * um, m.after.error ? std::optional(m.after.error->Sa * um) : std::nullopt, "µm",
                  (cover.empty() ? "" : cover + "; ") + before_in_words(m, fmt::format("{:.2f} µm", m.before.roughness.Sa * um))});
  list.push_back({"Layer thickness", m.thickness.mean * um, m.thickness_se ? std::optional(*m.thickness_se * um) : std::nullopt, "µm", "mean over the region"});
  if (m.after.packing.fraction)
    list.push_back({"Packing fraction", *m.after.packing.fraction, m.after.packing.se, "",
                    before_in_words(m, m.before.packing.fraction ? fmt::format("{:.3f}", *m.before.packing.fraction) : dash)});
  return list;
}

}  // namespace

report::Report layer_report(const LayerReportInput& in) {
  const LayerMeasurement& m = in.layer;
  Report page;
  page.title = "Layer";
  page.subtitle = fmt::format("{} grains, backend {}, seed {}", in.prepared.model.grain_count(), in.options.backend, in.options.seed);
  page.headlines = headlines_of(m);
  Warnings warnings;
  if (!in.bed.at_rest) warnings.items.push_back("the bed was not at rest when the spreader started: make layer.settle longer");
  for (const Doubt& doubt : doubts_of(m)) warnings.items.push_back(doubt.what + ": " + doubt.remedy);
  if (in.bed.converged_contacts < least_converged)
    warnings.items.push_back(fmt::format("the solver converged for {:.1f} % of the contacts of the settling bed only: make layer.settle_time_step smaller", 100 * in.bed.converged_contacts));
  if (m.lost > 0) warnings.items.push_back(fmt::format("{} grains lie below the plate", m.lost));
  for (const Finding& f : in.prepared.findings) warnings.items.push_back(f.place + ": " + f.message);
  for (const std::string& name : in.prepared.unsupported) warnings.items.push_back("left out, the backend cannot do it: " + name);
  page.sections.push_back({"", {warnings, Picture{in.surface_png, "The same region before and after, on one colour scale (0.1 % to 99.9 % of both), lit from the upper left; the spreader travels to the right. Black: the bare plate.", ""}}});
  Section surface{"Surface",
                  {profile_chart(in),
                   histogram_chart("Heights", "Heights of the cells of the surface that grains cover, as shares of all cells.", as_doubles(m.before.grid), as_doubles(m.after.grid)),
                   histogram_chart("Highest grains, tops", "Highest point of the highest grain in each square that has one.", without_nan(m.before.highest.top),
                                   without_nan(m.after.highest.top)),
                   Picture{in.thickness_png, "Layer thickness: the surface after minus the surface before, mean over a Gaussian as wide as a square (1 % to 99 %).", ""},
                   surface_table(m, *in.prepared.scene.layer), highest_table(m)}};
  if (m.after.squares.size() > 1) surface.blocks.push_back(squares_table(m));
  page.sections.push_back(std::move(surface));
  Section bed{"Bed", {}};
  if (auto picture = bed_picture(in)) bed.blocks.push_back(std::move(*picture));
  bed.blocks.push_back(bed_table(in));
  bed.blocks.push_back(depth_chart(m));
  bed.blocks.push_back(segregation_chart("Size by height", "height above the plate", um, "µm", m.before.segregation.by_height, m.after.segregation.by_height));
  bed.blocks.push_back(segregation_chart("Size along the travel", "x", mm, "mm", m.before.segregation.by_x, m.after.segregation.by_x));
  add_shape_charts(m.before.segregation, m.after.segregation, bed.blocks);
  page.sections.push_back(std::move(bed));
  if (in.half_step) page.sections.push_back({"Convergence in the step", {half_step_table(*in.half_step)}});
  if (!in.recording.steps.empty()) {
    Section loads{"Spreader and solver", {load_chart(in, false), load_chart(in, true)}};
    if (spreader_of(in.prepared.scene).yield) loads.blocks.push_back(rise_chart(in));
    loads.blocks.push_back(step_chart(in, true));
    loads.blocks.push_back(step_chart(in, false));
    page.sections.push_back(std::move(loads));
  }
  Settings settings{"Run", {}};
  settings.entries = {{"backend", in.options.backend},
                      {"seed", std::to_string(in.options.seed)},
                      {"steps", std::to_string(in.run.steps)},
                      {"time step", fmt::format("{:.3g} s", in.prepared.scene.solver.time_step)},
                      {"simulated", fmt::format("{:.4g} s", in.run.final_state.time)},
                      {"wall clock", fmt::format("{:.1f} s, bed {:.1f} s", in.run.wall_s, in.bed.wall_s)},
                      {"bed", in.bed.folder.string() + (in.bed.reused ? ", reused" : "")},
                      {"version", std::string(version()) + " (" + commit() + ")"}};
  page.sections.push_back({"Settings", {settings, Listing{"Scene as it was understood", in.prepared.scene.text}}});
  return page;
}

}  // namespace repose
