# Writes version.h, only when its text changes: no rebuild without a reason.
execute_process(COMMAND git describe --always --dirty --abbrev=10
  WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE hash
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT hash)
  set(hash "unknown")
endif()
set(text "#pragma once
#define SELKIE_VERSION \"${VERSION}\"
#define SELKIE_GIT_HASH \"${hash}\"
#define SELKIE_SCRIPTS_DIR \"${SOURCE}/scripts\"
#define SELKIE_BUILD_TYPE \"${BUILD_TYPE}\"
")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} old)
endif()
if(NOT "${old}" STREQUAL "${text}")
  file(WRITE ${OUTPUT} "${text}")
endif()
