#pragma once
/// Which build this is.

namespace repose {

/// The version of the project ("0.1.0").
const char* version();

/// What `git describe` says of the tree that was built ("3c42abb", with "-dirty" if files differ), or "unknown".
const char* commit();

}  // namespace repose
