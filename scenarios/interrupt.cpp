#include "scenarios/interrupt.hpp"

#include <csignal>

namespace repose {
namespace {

// A signal handler can reach nothing but an object of static storage.
volatile std::sig_atomic_t flag = 0;

void raise_flag(int) { flag = 1; }

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = raise_flag;
  // Resetting lets the second signal through; restarting keeps writes in progress whole.
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return flag != 0; }

}  // namespace repose
