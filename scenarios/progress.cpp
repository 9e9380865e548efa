#include "scenarios/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace repose {
namespace {

constexpr double line_interval_s = 5;
constexpr int bar_width = 30;
constexpr const char* clear_line = "\r\033[K";

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::size_t terminal_width() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 10 ? size.ws_col : 80;
}

}  // namespace

std::string duration_text(double seconds) {
  if (!(seconds < 1e9)) return "very long";
  const long s = std::lround(std::max(seconds, 0.0));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

ProgressDisplay::ProgressDisplay(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressDisplay::~ProgressDisplay() {
  if (bar_shown_) std::fputc('\n', stderr);
}

void ProgressDisplay::show(const Progress& p) {
  show(static_cast<double>(p.step), static_cast<double>(p.steps), p.remaining_s,
       fmt::format("t = {:.4g} s, {} contacts, {} iterations", p.time, p.report.contacts, p.report.iterations));
}

void ProgressDisplay::show(double done, double total, double remaining_s, const std::string& text) {
  if (quiet_) return;
  const double share = total > 0 ? std::clamp(done / total, 0.0, 1.0) : 1;
  const bool last = share >= 1;
  if (!terminal_ && !last && now_s() - last_line_s_ < line_interval_s) return;
  last_line_s_ = now_s();
  const std::string rest = last ? "done" : remaining_s > 0 ? duration_text(remaining_s) + " left" : "estimating";
  std::string line = fmt::format("{:3.0f} %  {}  {}", std::floor(100 * share), rest, text);
  if (!terminal_) {
    fmt::print(stderr, "{}\n", line);
    return;
  }
  const int filled = static_cast<int>(share * bar_width);
  line = fmt::format("[{:=<{}}{:<{}}] {}", "", filled, "", bar_width - filled, line);
  fmt::print(stderr, "{}{}", clear_line, line.substr(0, terminal_width() - 1));
  std::fflush(stderr);
  bar_shown_ = true;
}

void ProgressDisplay::message(const std::string& text) {
  fmt::print(stderr, "{}{}\n", bar_shown_ ? clear_line : "", text);
  bar_shown_ = false;
}

}  // namespace repose
