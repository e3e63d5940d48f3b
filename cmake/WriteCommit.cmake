# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
#
# cmake -DSOURCE=DIR -DOUTPUT=FILE -P WriteCommit.cmake: writes a header with the commit of the sources, " (1a2b3c4)",
# "-changed" behind it where they differ; nothing where they are in no git repository. Leaves the file alone when it
# says so already, so that nothing is compiled anew.
find_program(GIT git)
set(commit "")
if(GIT AND EXISTS "${SOURCE}/.git")
  execute_process(COMMAND "${GIT}" -C "${SOURCE}" describe --always --exclude=* --abbrev=7 --dirty=-changed
                  OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(commit " (${described})")
  endif()
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT "#define PSFM_COMMIT \"${commit}\"\n" @ONLY)
