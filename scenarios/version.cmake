# Writes OUTPUT, a source file with the version and the commit, only when its content changes: run at every build, it costs
# nothing unless there is a new commit.
set(commit unknown)
find_program(GIT git)
if(GIT)
  # Without optional locks: this must never stand in the way of a commit.
  execute_process(COMMAND ${GIT} --no-optional-locks describe --always --dirty --abbrev=12
                  WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE described RESULT_VARIABLE status
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(status EQUAL 0 AND described)
    set(commit ${described})
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[
#include "scenarios/version.hpp"

namespace repose {
const char* version() { return "@VERSION@"; }
const char* commit() { return "@commit@"; }
}  // namespace repose
]] @ONLY)
