# Run in every build: writes OUTPUT, which tells the program the commit that is built now. Takes what the configuration found as -D NAME=VALUE.
set(SILT_COMMIT "unknown")  # of a tree without git
find_program(GIT git)
if(GIT)
  execute_process(COMMAND ${GIT} -C ${SOURCE} describe --always --dirty
                  OUTPUT_VARIABLE described RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed AND described)
    set(SILT_COMMIT "${described}")
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[// Made by build_info.cmake.
#include "silt/results/build_info.hpp"

const silt::adapters::Provenance& silt::build_info() {
  static const adapters::Provenance info = [] {
    adapters::Provenance p;
    p.version = "@VERSION@", p.commit = "@SILT_COMMIT@";
    p.compiler = "@COMPILER@", p.flags = "@FLAGS@", p.libraries = "@LIBRARIES@";
    return p;
  }();
  return info;
}
]])  # leaves it alone if nothing changed
