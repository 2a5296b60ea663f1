# Run in every build: writes OUTPUT from build_info.cpp.in with the commit that is built now. Takes what the configuration found as -D NAME=VALUE.
set(SILT_COMMIT "unknown")  # of a tree without git
find_program(GIT git)
if(GIT)
  execute_process(COMMAND ${GIT} -C ${SOURCE} describe --always --dirty
                  OUTPUT_VARIABLE described RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed AND described)
    set(SILT_COMMIT "${described}")
  endif()
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/build_info.cpp.in ${OUTPUT} @ONLY)  # leaves it alone if nothing changed
