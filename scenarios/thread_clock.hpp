#pragma once
/// How long the calling thread has been computing: what a run costs, whatever else the machine does.
#include <ctime>

namespace repose {

/// Processor time of the calling thread [s], from an arbitrary start. A simulation with one thread costs the difference of two readings.
inline double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace repose
