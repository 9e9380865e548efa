#pragma once
/// What a simulation of a few bodies did at every step, and the function by which an analysis asks for one.
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/math.hpp"
#include "core/model.hpp"
#include "core/scene.hpp"

namespace repose {

/// One body at every step. Arrays as long as History::time.
struct BodyTrack {
  std::vector<Vec3> position;     ///< of the shape's own origin [m]
  std::vector<Quat> orientation;  ///< of the shape's own frame
  std::vector<Vec3> velocity;     ///< of the own origin [m/s]
  std::vector<Vec3> spin;         ///< [rad/s], world
  // From the contacts of the step; only if SimulationRequest::contacts.
  std::vector<double> normal_force;  ///< sum over its contacts [N]
  std::vector<double> slip_speed;    ///< at the contact with the largest normal force [m/s]; 0 without one
  std::vector<double> approach;      ///< normal speed of approach before the step there [m/s]; > 0 in an impact
};

struct History {
  std::vector<double> time;                           ///< [s], ascending, from the scene's start
  std::map<std::string, BodyTrack> bodies;            ///< explicit bodies that move freely, by name
  std::map<std::string, double> radius;               ///< of the sphere of equal volume [m], by name
  std::map<std::string, double> mass;                 ///< [kg], by name
  Vec3 gravity = Vec3::Zero();                        ///< with any tilt [m/s^2]
  std::map<std::string, std::vector<double>> series;  ///< those asked for, at `time`
  bool converged = true;                              ///< at least 95 % of the steps
  bool smooth = false;                                ///< between steps bodies move on cubics of their velocities at both ends
};

/// A force and a torque on one body while `from` <= t < `to`, world frame.
struct WindowLoad {
  std::string body;
  double from = 0, to = 0;                           ///< [s]
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();  ///< [N], [N m]
};

struct SimulationRequest {
  const Scene* scene = nullptr;
  std::uint64_t seed = 1;
  double until = 0;                 ///< [s]; 0: the scene's duration
  bool contacts = false;            ///< fill what comes from contacts
  std::vector<std::string> series;  ///< bulk series to record: reserved names
  std::vector<WindowLoad> loads;
  std::string backend;              ///< that runs it, by its name; empty: the analysis's own
  bool until_rest = false;          ///< end as soon as the heap on the base is at rest, seen once a frame interval
};

/// Runs a scene. May be called from several threads at once. Throws Error (Kind::simulation) if the run fails.
using Simulate = std::function<History(const SimulationRequest&)>;

/// Position, orientation and velocity of a body at any time: straight lines between steps (cubics in a smooth history), the start state before them,
/// the final state after them.
struct BodySample {
  Vec3 position, velocity, spin;
  Quat orientation;
};
BodySample sample(const History& history, const BodyTrack& track, double time);

/// What an accelerometer reads along `axis` (unit, body frame) at `time`, averaged over `window` [s] > 0 around it:
///   a = axis . R^T (dv/dt - g)     [m/s^2]; 0 in a vacuum fall. Of the own origin.
double specific_force(const History& history, const BodyTrack& track, const Vec3& axis, double time, double window);

/// A series of History::series at any time, by straight lines; constant outside.
double sample(const History& history, const std::vector<double>& series, double time);

}  // namespace repose
