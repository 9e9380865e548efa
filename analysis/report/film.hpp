#pragma once
/// Films as web pages.
#include <string>
#include <vector>

namespace repose {

struct FilmFrame {
  double time = 0;   ///< simulated [s]
  std::string jpeg;  ///< bytes of a JPEG file
};

/// One self-contained page with the frames inside: play, pause, a slider, the arrow keys. It plays `frames_per_second`
/// frames in a second of the viewer's time. Throws Error if there are no frames or the rate is not positive.
std::string film_html(const std::string& title, const std::vector<FilmFrame>& frames, double frames_per_second);

}  // namespace repose
