#include "analysis/diagnosis/segments.hpp"

#include <algorithm>

namespace repose::diagnosis {
namespace {

constexpr double small_share = 0.05;  // of the speed

}  // namespace

double gravity_scale(const History& history) {
  const double g = history.gravity.norm();
  return g > 0 ? g : 9.81;
}

const std::string& phase_name(Phase phase) {
  static const std::string names[] = {"flight", "impact", "sliding", "rolling", "rest"};
  return names[static_cast<std::size_t>(phase)];
}

std::vector<Phase> phases_of(const History& history, const BodyTrack& track, double radius) {
  const double g = gravity_scale(history), slow = 0.01 * std::sqrt(g * radius);
  std::vector<Phase> phases;
  for (std::size_t i = 0; i < history.time.size(); ++i) {
    const double h = i > 0 ? history.time[i] - history.time[i - 1] : 0, speed = track.velocity[i].norm();
    if (track.normal_force[i] <= 0)
      phases.push_back(Phase::flight);
    else if (track.approach[i] > 3 * g * h + slow)
      phases.push_back(Phase::impact);
    else if (speed < slow && track.spin[i].norm() * radius < slow)
      phases.push_back(Phase::rest);
    else if (track.slip_speed[i] >= small_share * std::max(speed, slow))
      phases.push_back(Phase::sliding);
    else
      phases.push_back(track.spin[i].norm() * radius < small_share * speed ? Phase::rest : Phase::rolling);
  }
  if (phases.size() > 1) phases[0] = phases[1];  // the start has no contacts yet
  return phases;
}

Segment joined(const Segment& a, const Segment& b) {
  Segment both = a;
  const double share = b.to > a.from ? (b.to - b.from) / (b.to - a.from) : 0;
  const auto mean = [&](double Segment::*of) { return (1 - share) * a.*of + share * b.*of; };
  both.to = b.to;
  both.speed = mean(&Segment::speed);
  both.slip_speed = mean(&Segment::slip_speed);
  both.spin = mean(&Segment::spin);
  both.normal_force = mean(&Segment::normal_force);
  both.height = mean(&Segment::height);
  both.time = mean(&Segment::time);
  both.velocity = (1 - share) * a.velocity + share * b.velocity;
  return both;
}

std::vector<Segment> segments_of(const History& history, const std::string& body, double until, int parts) {
  const BodyTrack& track = history.bodies.at(body);
  const std::vector<Phase> phases = phases_of(history, track, history.radius.at(body));
  std::vector<Segment> segments;
  const auto last = static_cast<std::size_t>(std::upper_bound(history.time.begin(), history.time.end(), until) - history.time.begin());
  const double longest = until / parts;
  std::size_t from = 0;
  const auto close = [&](std::size_t to) {
    if (to <= from) return;
    Segment s;
    s.body = body;
    s.phase = phases[from];
    s.from = history.time[from];
    s.to = history.time[std::min(to, history.time.size() - 1)];
    const auto n = static_cast<double>(to - from);
    for (std::size_t i = from; i < to; ++i) {
      s.speed += track.velocity[i].norm() / n;
      s.slip_speed += track.slip_speed[i] / n;
      s.spin += track.spin[i].norm() / n;
      s.normal_force += track.normal_force[i] / n;
      s.height += track.position[i].z() / n;
      s.time += history.time[i] / n;
      s.velocity += track.velocity[i] / n;
    }
    segments.push_back(s);
    from = to;
  };
  for (std::size_t i = 1; i < last; ++i)
    if (phases[i] != phases[from] || history.time[i] - history.time[from] >= longest) close(i);
  close(last);
  // Chattering between phases makes slivers: they join what came before, but for impacts.
  std::vector<Segment> joined;
  for (const Segment& s : segments) {
    if (!joined.empty() && s.to - s.from < 0.1 * longest && s.phase != Phase::impact && joined.back().phase != Phase::impact)
      joined.back().to = s.to;
    else
      joined.push_back(s);
  }
  return joined;
}

}  // namespace repose::diagnosis
