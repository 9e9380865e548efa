#include "analysis/report/film.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "analysis/report/markup.hpp"
#include "core/error.hpp"

namespace repose {
namespace embedded {
std::string_view film_page();
}

namespace {

void replace_all(std::string& text, std::string_view what, std::string_view by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
}

}  // namespace

std::string film_html(const std::string& title, const std::vector<FilmFrame>& frames, double frames_per_second) {
  if (frames.empty()) throw Error("film", "it has no frames", "choose a run that recorded some");
  if (!(frames_per_second > 0) || !std::isfinite(frames_per_second))
    throw Error("film", fmt::format("{} frames per second", frames_per_second), "give a positive rate");
  std::string data = fmt::format("{{\"rate\":{},\"frames\":[", frames_per_second);
  for (std::size_t i = 0; i < frames.size(); ++i)
    data +=
        fmt::format("{}{{\"time\":{},\"jpeg\":\"{}\"}}", i ? "," : "", frames[i].time, report::base64(frames[i].jpeg));
  data += "]}";
  std::string page(embedded::film_page());
  replace_all(page, "@film@", data);
  replace_all(page, "@title@", report::escaped(title));
  return page;
}

}  // namespace repose
