#include "analysis/report/report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>

#include "analysis/report/chart_data.hpp"
#include "analysis/report/film.hpp"
#include "analysis/report/markup.hpp"
#include "core/error.hpp"
#include "tests/browser/sample_report.hpp"

namespace repose::report {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Markup, escapes_and_encodes) {
  EXPECT_EQ(escaped("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
  // The examples of RFC 4648.
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xff\x00\xfe", 3)), "/wD+");
}

TEST(Markup, numbers_as_people_read_them) {
  EXPECT_EQ(number(0.45), "0.45");
  EXPECT_EQ(number(2.31e-5), "2.31×10⁻⁵");
  EXPECT_EQ(number(-1e12), "-1×10¹²");
  EXPECT_EQ(number(nan), "");
}

TEST(Rounded, two_digits_of_the_uncertainty_three_if_it_begins_with_one) {
  EXPECT_EQ(rounded(32.934, 1.1512), "32.93 ± 1.15");
  EXPECT_EQ(rounded(32.934, 0.42), "32.93 ± 0.42");
  EXPECT_EQ(rounded(0.45124, 0.0031), "0.4512 ± 0.0031");
  EXPECT_EQ(rounded(1234.5, 56.7), "1234 ± 57");
  EXPECT_EQ(rounded(315.045, 257.0), "320 ± 260");
  EXPECT_EQ(rounded(-123456, 1234), "-123460 ± 1230");
  EXPECT_EQ(rounded(6.52242e-17, 1.34e-17), "(6.52 ± 1.34)×10⁻¹⁷");
  EXPECT_EQ(rounded(3.6e-7, 3.6e-7), "(3.6 ± 3.6)×10⁻⁷");
  EXPECT_EQ(rounded(0, 2.5e7), "(0.0 ± 2.5)×10⁷");
  EXPECT_EQ(rounded(32.934), "32.93");
  EXPECT_EQ(rounded(32.934, 0.0), "32.93");
}

TEST(Report, is_one_file_that_loads_nothing) {
  const std::string html = to_html(sample_report());
  EXPECT_EQ(html.find("<link"), std::string::npos);
  EXPECT_EQ(html.find("@import"), std::string::npos);
  EXPECT_FALSE(std::regex_search(html, std::regex("(src|href)=[\"']?(https?:)?//")));
  EXPECT_FALSE(std::regex_search(html, std::regex("url\\((?!data:)")));
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
}

TEST(Report, escapes_every_text) {
  const std::string nasty = "</script><b onclick=\"x\">&";
  Report r;
  r.title = r.subtitle = nasty;
  r.headlines = {{nasty, 1, 0.1, nasty, nasty}};
  Chart chart{nasty,
              nasty,
              {nasty, nasty, false},
              {nasty, nasty, false},
              {{nasty, {1}, {1}, {}, Series::Style::points, false}},
              {{nasty, 1, 0}},
              false};
  r.sections = {{nasty,
                 {Text{nasty}, chart, Table{nasty, {nasty}, {{nasty}}, {nasty}}, Settings{nasty, {{nasty, nasty}}},
                  Listing{nasty, nasty}, Warnings{{nasty}}}}};
  EXPECT_EQ(to_html(r).find("<b onclick"), std::string::npos);
}

TEST(Report, charts_are_also_tables) {
  Chart chart;
  chart.title = "t";
  chart.y.unit = "mm";
  chart.series = {{"s", {1, 2}, {3.25, nan}, {0.5, nan}, Series::Style::points, false}};
  const std::string html = to_html({"", "", {}, {{"", {chart}}}});
  EXPECT_NE(html.find("<td class=\"n\">1</td><td class=\"n\">3.25</td><td class=\"n\">0.5</td>"), std::string::npos);
  EXPECT_NE(html.find("<td class=\"n\">2</td><td class=\"n\"></td><td class=\"n\"></td>"), std::string::npos);
}

TEST(Report, windows_are_in_the_data_and_in_the_table) {
  Chart chart;
  chart.title = "t";
  chart.series = {{"s", {1, 2}, {3, 4}, {}, Series::Style::points, false}};
  chart.windows = {{"rolling", 0.125, 0.5}};
  const std::string html = to_html({"", "", {}, {{"", {chart}}}});
  EXPECT_NE(html.find("<th scope=\"row\">rolling</th><td class=\"n\">0.125 – 0.5</td>"), std::string::npos);
  std::size_t left_out = 0;
  EXPECT_EQ(nlohmann::json::parse(chart_json(chart, left_out))["windows"][0]["to"], 0.5);
}

TEST(Report, bars_are_as_long_as_their_share) {
  const std::string html = to_html({"", "", {}, {{"", {Bars{"b", {{"one", 0.25, "note", true}, {"two", 0.0004, "", false}}, ""}}}}});
  EXPECT_NE(html.find("width:25.00%"), std::string::npos);
  EXPECT_NE(html.find(">25 %<"), std::string::npos);
  EXPECT_NE(html.find("&lt; 0.1 %"), std::string::npos);
}

TEST(ChartData, gaps_are_null_and_logarithms_leave_out_what_they_cannot_show) {
  Chart chart;
  chart.y.logarithmic = true;
  chart.series = {{"s", {1, 2, 3, 4}, {1, 0, nan, 2}, {}, Series::Style::line, false}};
  std::size_t left_out = 0;
  const auto json = nlohmann::json::parse(chart_json(chart, left_out));
  EXPECT_EQ(left_out, 1U);
  const auto& data = json["series"][0]["data"];
  ASSERT_EQ(data.size(), 3U);
  EXPECT_EQ(data[0]["y"], 1.0);
  EXPECT_TRUE(data[1]["y"].is_null());
  EXPECT_EQ(data[2]["x"], 4.0);
}

TEST(ChartData, thinning_keeps_ends_extremes_and_gaps) {
  std::vector<double> y(100000);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = std::sin(static_cast<double>(i) * 0.7);
  y[31415] = 7;
  y[27182] = -9;
  y[50000] = nan;
  const auto kept = thinned(y, 1000);
  EXPECT_LE(kept.size(), 1002U);
  EXPECT_EQ(kept.front(), 0U);
  EXPECT_EQ(kept.back(), y.size() - 1);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  for (const std::size_t wanted : {31415U, 27182U, 50000U})
    EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), wanted));
  EXPECT_EQ(thinned(y, y.size()).size(), y.size());
}

TEST(Report, refuses_what_does_not_fit_together) {
  const auto with = [](const Block& block) { return Report{"t", "", {}, {{"", {block}}}}; };
  Chart chart;
  chart.series = {{"s", {1, 2}, {1}, {}, Series::Style::line, false}};
  EXPECT_THROW(to_html(with(chart)), Error);
  chart.series = {{"s", {1, 2}, {1, 2}, {1}, Series::Style::line, false}};
  EXPECT_THROW(to_html(with(chart)), Error);
  chart.series.clear();
  chart.bands = {{"b", nan, 0}};
  EXPECT_THROW(to_html(with(chart)), Error);
  chart.bands.clear();
  chart.windows = {{"w", 2, 1}};
  EXPECT_THROW(to_html(with(chart)), Error);
  EXPECT_THROW(to_html(with(Bars{"b", {{"one", 1.1, "", false}}, ""})), Error);
  EXPECT_THROW(to_html(with(Table{"t", {"a", "b"}, {{"1"}}, {}})), Error);
  EXPECT_THROW(to_html(with(Picture{"not a png", "", ""})), Error);
  EXPECT_THROW(to_html({"t", "", {{"h", nan, {}, "", ""}}, {}}), Error);
}

TEST(Film, holds_its_frames_and_nothing_else) {
  const std::string html = film_html("a <film>", {{0, "abc"}, {0.5, "def"}}, 25);
  EXPECT_NE(html.find("YWJj"), std::string::npos);
  EXPECT_NE(html.find("ZGVm"), std::string::npos);
  EXPECT_NE(html.find("a &lt;film&gt;"), std::string::npos);
  EXPECT_EQ(html.find("@film@"), std::string::npos);
  EXPECT_FALSE(std::regex_search(html, std::regex("https?://")));
  EXPECT_THROW(film_html("", {}, 25), Error);
  EXPECT_THROW(film_html("", {{0, "abc"}}, 0), Error);
}

}  // namespace
}  // namespace repose::report
