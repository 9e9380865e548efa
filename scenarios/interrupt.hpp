#pragma once
/// Ctrl-C as a flag that loops ask for.

namespace repose {

/// From now on the first SIGINT or SIGTERM only sets the flag; a second one ends the process as usual.
void catch_interrupts();

/// True once a signal has come.
bool interrupted();

}  // namespace repose
