#pragma once
/// A document of pictures, charts and tables, and its writing as one HTML file that opens without network.
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace repose::report {

/// The answer, in large type: "32.9 ± 1.2 °".
struct Headline {
  std::string label;  ///< "Angle of repose"
  double value = 0;
  std::optional<double> uncertainty;  ///< in the unit of `value`, >= 0
  std::string unit;                   ///< "°", "kg/m³"; may be empty
  std::string note;                   ///< what the uncertainty is, what to compare with; may be empty
};

/// Paragraphs, parted by empty lines.
struct Text {
  std::string text;
};

struct Picture {
  std::string png;  ///< bytes of a PNG file
  std::string caption;
  std::string alt;  ///< what a blind reader must know; the caption if empty
};

struct Axis {
  std::string label, unit;   ///< unit may be empty
  bool logarithmic = false;  ///< points that are not positive are left out, and the chart says how many
};

/// Points of a chart. A NaN in `y` is a missing sample: the line has a gap there.
struct Series {
  enum class Style { points, line, line_and_points };
  std::string name;
  std::vector<double> x, y;
  std::vector<double> error;  ///< half length of the vertical error bar; empty: none; NaN: none at this point
  Style style = Style::line;
  bool dashed = false;
};

/// A horizontal reference: a measured value with its uncertainty.
struct Band {
  std::string name;
  double value = 0, half_width = 0;  ///< half_width 0: a line
};

/// A stretch of the x axis, shaded: where something was found.
struct Window {
  std::string name;  ///< written into it where there is room
  double from = 0, to = 0;
};

/// Drawn by the reader's browser, and given as a table below for who cannot see it.
struct Chart {
  std::string title, caption;
  Axis x, y;
  std::vector<Series> series;
  std::vector<Band> bands;
  bool equal_scales = false;  ///< a metre is as long on x as on y (a heap's profile)
  std::vector<Window> windows = {};
  bool low = false;           ///< half as high: one of many
};

/// Shares of a whole, as horizontal bars: probabilities.
struct Bar {
  std::string label;
  double share = 0;   ///< in [0, 1]
  std::string note;   ///< beside the share; may be empty
  bool strong = false;  ///< the answer
};
struct Bars {
  std::string title;
  std::vector<Bar> bars;
  std::string caption;  ///< may be empty
};

struct Table {
  std::string title;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  ///< each as long as the header; cells that are numbers go right
  std::vector<std::string> notes;
};

struct Settings {
  std::string title;
  std::vector<std::pair<std::string, std::string>> entries;
};

/// Text kept as it is, in a box that opens on demand: the resolved scene.
struct Listing {
  std::string title, text;
};

struct Warnings {
  std::vector<std::string> items;  ///< empty: nothing is shown
};

using Block = std::variant<Text, Picture, Chart, Bars, Table, Settings, Listing, Warnings>;

struct Section {
  std::string heading;  ///< may be empty
  std::vector<Block> blocks;
};

struct Report {
  std::string title, subtitle;
  std::vector<Headline> headlines;  ///< the first is the largest
  std::vector<Section> sections;
  std::string lead = {};            ///< the answer in words, under the title; may be empty
};

/// One self-contained file: pictures, charts and the program that draws them are inside, and it forbids itself to load
/// anything. Light and dark, printable. All text is escaped. A series of more than 4000 points is thinned for the
/// chart, keeping the extremes of every stretch. Throws Error if arrays of a series or rows of a table differ in
/// length, or a headline, a band or a window is not finite, or a share is outside [0, 1].
std::string to_html(const Report& report);

/// "32.93 ± 1.15": the uncertainty to two digits (three if it begins with 1), the value to the same place. Without one:
/// four digits.
std::string rounded(double value, std::optional<double> uncertainty = std::nullopt);

/// "98 %", "0.4 %", "< 0.1 %".
std::string percent(double share);

}  // namespace repose::report
