#include "analysis/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "analysis/report/chart_data.hpp"
#include "analysis/report/markup.hpp"
#include "core/error.hpp"

namespace repose {
namespace embedded {
std::string_view chart_library();
std::string_view report_script();
std::string_view report_style();
}  // namespace embedded

namespace report {
namespace {

constexpr std::size_t most_table_rows = 60;

void fail(const std::string& place, const std::string& problem) {
  throw Error("report, " + place, problem, "mend the document before it is written");
}

void check(const Chart& chart) {
  const std::string place = "chart '" + chart.title + "'";
  for (const Series& s : chart.series)
    if (s.x.size() != s.y.size() || (!s.error.empty() && s.error.size() != s.y.size()))
      fail(place, fmt::format("series '{}' has {} x, {} y and {} error values", s.name, s.x.size(), s.y.size(),
                              s.error.size()));
  for (const Band& b : chart.bands)
    if (!std::isfinite(b.value) || !(b.half_width >= 0) || !std::isfinite(b.half_width))
      fail(place, "the reference '" + b.name + "' is not a finite value with a half width of at least 0");
  for (const Window& w : chart.windows)
    if (!std::isfinite(w.from) || !std::isfinite(w.to) || w.to < w.from)
      fail(place, "the window '" + w.name + "' does not end after it begins");
}

/// The HTML under construction; charts are numbered so that their canvases have names.
struct Page {
  std::string html;
  int charts = 0;

  void operator()(const Text& text);
  void operator()(const Picture& picture);
  void operator()(const Chart& chart);
  void operator()(const Bars& bars);
  void operator()(const Table& table);
  void operator()(const Settings& settings);
  void operator()(const Listing& listing);
  void operator()(const Warnings& warnings);
  void series_table(const Chart& chart, const Series& series);
};

void Page::operator()(const Text& text) {
  std::size_t from = 0;
  while (from < text.text.size()) {
    const std::size_t to = std::min(text.text.find("\n\n", from), text.text.size());
    html += "<p>" + escaped(std::string_view(text.text).substr(from, to - from)) + "</p>\n";
    from = text.text.find_first_not_of('\n', to);
  }
}

void Page::operator()(const Picture& picture) {
  static constexpr std::string_view signature = "\x89PNG\r\n\x1a\n";
  if (std::string_view(picture.png).substr(0, signature.size()) != signature)
    fail("picture '" + picture.caption + "'", "its bytes are not a PNG file");
  const std::string alt = escaped(picture.alt.empty() ? picture.caption : picture.alt);
  html +=
      "<figure class=\"picture\"><img alt=\"" + alt + "\" src=\"data:image/png;base64," + base64(picture.png) + "\">";
  if (!picture.caption.empty()) html += "<figcaption>" + escaped(picture.caption) + "</figcaption>";
  html += "</figure>\n";
}

void Page::series_table(const Chart& chart, const Series& series) {
  const std::size_t n = series.y.size(), step = std::max<std::size_t>(1, (n + most_table_rows - 1) / most_table_rows);
  const auto heading = [](const Axis& axis) {
    return "<th scope=\"col\">" + escaped(axis.label) + (axis.unit.empty() ? "" : " [" + escaped(axis.unit) + "]") +
           "</th>";
  };
  html += "<table><caption>" + escaped(series.name);
  if (step > 1) html += fmt::format(" (one point in {} of {} is listed)", step, n);
  html += "</caption><thead><tr>" + heading(chart.x) + heading(chart.y);
  if (!series.error.empty()) html += "<th scope=\"col\">±</th>";
  html += "</tr></thead><tbody>\n";
  for (std::size_t i = 0; i < n; i += step) {
    html += "<tr><td class=\"n\">" + number(series.x[i]) + "</td><td class=\"n\">" + number(series.y[i]) + "</td>";
    if (!series.error.empty()) html += "<td class=\"n\">" + number(series.error[i], 3) + "</td>";
    html += "</tr>\n";
  }
  html += "</tbody></table>\n";
}

void Page::operator()(const Chart& chart) {
  check(chart);
  std::size_t left_out = 0;
  const std::string data = chart_json(chart, left_out);
  const std::string id = "chart-" + std::to_string(++charts);
  html += "<figure class=\"chart\"><h3 id=\"" + id + "-title\">" + escaped(chart.title) + "</h3>";
  html +=
      std::string("<div class=\"plot") + (chart.low ? " low" : "") + "\"><canvas id=\"" + id + "\" role=\"img\" aria-labelledby=\"" + id + "-title\"></canvas></div>";
  html += "<script type=\"application/json\" class=\"chart-data\" data-canvas=\"" + id + "\">" + data + "</script>";
  std::string caption = escaped(chart.caption);
  if (left_out > 0)
    caption += fmt::format(" {} point{} that a logarithmic axis cannot show {} left out.", left_out,
                           left_out == 1 ? "" : "s", left_out == 1 ? "is" : "are");
  if (!caption.empty()) html += "<figcaption>" + caption + "</figcaption>";
  html += "<details><summary>Values</summary><div class=\"values\">\n";
  for (const Series& series : chart.series) series_table(chart, series);
  if (!chart.bands.empty()) {
    html += "<table><caption>References</caption><tbody>";
    for (const Band& b : chart.bands)
      html += "<tr><th scope=\"row\">" + escaped(b.name) + "</th><td class=\"n\">" + number(b.value) +
              (b.half_width > 0 ? " ± " + number(b.half_width, 3) : "") + "</td></tr>";
    html += "</tbody></table>\n";
  }
  if (!chart.windows.empty()) {
    html += "<table><caption>Shaded</caption><tbody>";
    for (const Window& w : chart.windows)
      html += "<tr><th scope=\"row\">" + escaped(w.name) + "</th><td class=\"n\">" + number(w.from, 4) + " – " + number(w.to, 4) + "</td></tr>";
    html += "</tbody></table>\n";
  }
  html += "</div></details></figure>\n";
}

void Page::operator()(const Bars& bars) {
  html += "<figure class=\"bars\">";
  if (!bars.title.empty()) html += "<h3>" + escaped(bars.title) + "</h3>";
  html += "<ul>\n";
  for (const Bar& b : bars.bars) {
    if (!(b.share >= 0 && b.share <= 1)) fail("bars '" + bars.title + "'", "the share of '" + b.label + "' is not between 0 and 1");
    html += std::string("<li") + (b.strong ? " class=\"strong\"" : "") + "><span class=\"label\">" + escaped(b.label) + "</span>";
    html += fmt::format("<span class=\"track\"><span class=\"fill\" style=\"width:{:.2f}%\"></span></span>", 100 * b.share);
    html += "<span class=\"share\">" + escaped(percent(b.share)) + "</span><span class=\"note\">" + escaped(b.note) + "</span></li>\n";
  }
  html += "</ul>";
  if (!bars.caption.empty()) html += "<figcaption>" + escaped(bars.caption) + "</figcaption>";
  html += "</figure>\n";
}

bool looks_numeric(const std::string& cell) {
  const bool signs = cell.find_first_not_of("0123456789+-.,eE ()±−%∞×⁰¹²³⁴⁵⁶⁷⁸⁹⁻") == std::string::npos;
  return signs && cell.find_first_of("0123456789") != std::string::npos;
}

void Page::operator()(const Table& table) {
  html += "<figure class=\"table\"><table>";
  if (!table.title.empty()) html += "<caption>" + escaped(table.title) + "</caption>";
  html += "<thead><tr>";
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    const bool numeric = std::any_of(table.rows.begin(), table.rows.end(),
                                     [&](const auto& row) { return c < row.size() && looks_numeric(row[c]); });
    html +=
        std::string("<th scope=\"col\"") + (numeric ? " class=\"n\"" : "") + ">" + escaped(table.header[c]) + "</th>";
  }
  html += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    if (row.size() != table.header.size())
      fail("table '" + table.title + "'",
           fmt::format("a row has {} cells, the header {}", row.size(), table.header.size()));
    html += "<tr>";
    for (const std::string& cell : row)
      html += std::string("<td") + (looks_numeric(cell) ? " class=\"n\"" : "") + ">" + escaped(cell) + "</td>";
    html += "</tr>\n";
  }
  html += "</tbody></table>";
  if (!table.notes.empty()) {
    html += "<figcaption>";
    for (const std::string& note : table.notes) html += "<p>" + escaped(note) + "</p>";
    html += "</figcaption>";
  }
  html += "</figure>\n";
}

void Page::operator()(const Settings& settings) {
  if (!settings.title.empty()) html += "<h3>" + escaped(settings.title) + "</h3>";
  html += "<dl>";
  for (const auto& [key, value] : settings.entries)
    html += "<div><dt>" + escaped(key) + "</dt><dd>" + escaped(value) + "</dd></div>";
  html += "</dl>\n";
}

void Page::operator()(const Listing& listing) {
  html += "<details class=\"listing\"><summary>" + escaped(listing.title) + "</summary><pre>" + escaped(listing.text) +
          "</pre></details>\n";
}

void Page::operator()(const Warnings& warnings) {
  if (warnings.items.empty()) return;
  html += "<aside class=\"warnings\" aria-label=\"Warnings\"><ul>";
  for (const std::string& item : warnings.items) html += "<li>" + escaped(item) + "</li>";
  html += "</ul></aside>\n";
}

std::string headline_html(const Headline& h, bool first) {
  if (!std::isfinite(h.value) || (h.uncertainty && !(*h.uncertainty >= 0 && std::isfinite(*h.uncertainty))))
    fail("headline '" + h.label + "'", "its value or uncertainty is not finite");
  const std::string text = rounded(h.value, h.uncertainty);
  const std::size_t split = text.find(" ±");
  std::string html = first ? "<div class=\"headline first\">" : "<div class=\"headline\">";
  html += "<div class=\"label\">" + escaped(h.label) + "</div><div class=\"value\">" + text.substr(0, split);
  if (split != std::string::npos) html += "<span class=\"pm\">" + text.substr(split) + "</span>";
  if (!h.unit.empty()) html += "<span class=\"unit\"> " + escaped(h.unit) + "</span>";
  html += "</div>";
  if (!h.note.empty()) html += "<div class=\"note\">" + escaped(h.note) + "</div>";
  return html + "</div>\n";
}

}  // namespace

std::string rounded(double value, std::optional<double> uncertainty) {
  const bool usable = uncertainty && std::isfinite(*uncertainty) && *uncertainty > 0;
  if (!usable || !std::isfinite(value)) return number(value, 4);
  const int exponent = static_cast<int>(std::floor(std::log10(*uncertainty)));
  const bool starts_with_one = *uncertainty / std::pow(10, exponent) < 1.95;
  const int places = (starts_with_one ? 2 : 1) - exponent, top = static_cast<int>(std::floor(std::log10(std::max(std::abs(value), *uncertainty))));
  const auto both = [](double v, double u, int decimals) {
    const double unit = std::pow(10, -std::min(decimals, 0));  // digits before the point that the uncertainty leaves open are zeros
    const int shown = std::max(decimals, 0);
    return fmt::format("{:.{}f} ± {:.{}f}", decimals < 0 ? unit * std::round(v / unit) : v, shown, decimals < 0 ? unit * std::round(u / unit) : u, shown);
  };
  if (top >= -4 && top < 6) return both(value, *uncertainty, places);
  const double power = std::pow(10, top);
  return "(" + both(value / power, *uncertainty / power, places + top) + ")" + number(power, 1).substr(1);
}

std::string percent(double share) {
  if (share > 0 && share < 0.001) return "< 0.1 %";
  if (share < 1 && share > 0.999) return "> 99.9 %";
  return fmt::format("{:.{}f} %", 100 * share, share == 0 || share == 1 || (share >= 0.1 && share < 0.99) ? 0 : 1);
}

std::string to_html(const Report& report) {
  Page page;
  std::string& html = page.html;
  html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
      escaped(report.title) + "</title>\n<style>";
  html += embedded::report_style();
  html += "</style>\n</head>\n<body>\n<main>\n<header><h1>" + escaped(report.title) + "</h1>";
  if (!report.subtitle.empty()) html += "<p class=\"subtitle\">" + escaped(report.subtitle) + "</p>";
  if (!report.lead.empty()) html += "<p class=\"lead\">" + escaped(report.lead) + "</p>";
  html += "</header>\n";
  if (!report.headlines.empty()) {
    html += "<div class=\"headlines\">";
    for (std::size_t i = 0; i < report.headlines.size(); ++i) html += headline_html(report.headlines[i], i == 0);
    html += "</div>\n";
  }
  for (const Section& section : report.sections) {
    html += "<section>";
    if (!section.heading.empty()) html += "<h2>" + escaped(section.heading) + "</h2>\n";
    for (const Block& block : section.blocks) std::visit(page, block);
    html += "</section>\n";
  }
  html += "</main>\n";
  if (page.charts > 0) {
    html += "<script>";
    html += embedded::chart_library();
    html += "</script>\n<script>";
    html += embedded::report_script();
    html += "</script>\n";
  }
  return html + "</body>\n</html>\n";
}

}  // namespace report
}  // namespace repose
