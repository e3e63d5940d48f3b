# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
#
# cmake --install: bin/psfm, the libraries, their headers under include/psfm (included as "graph/ids.h",
# as here), and a package: find_package(psfm CONFIG) gives psfm::graph, psfm::stages and so on.
# psfm_add_library adds each library to the export set psfmTargets.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(PSFM_INSTALL_INCLUDE "${CMAKE_INSTALL_INCLUDEDIR}/psfm")
set(PSFM_INSTALL_CMAKE "${CMAKE_INSTALL_LIBDIR}/cmake/psfm")

foreach(folder IN ITEMS graph stages storage scheduler)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/${folder}" DESTINATION "${PSFM_INSTALL_INCLUDE}"
          COMPONENT dev FILES_MATCHING PATTERN "*.h")
endforeach()
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)

install(EXPORT psfmTargets NAMESPACE psfm:: DESTINATION "${PSFM_INSTALL_CMAKE}" COMPONENT dev)
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/psfmConfig.cmake.in"
                              "${PROJECT_BINARY_DIR}/psfmConfig.cmake"
                              INSTALL_DESTINATION "${PSFM_INSTALL_CMAKE}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/psfmConfigVersion.cmake"
                                 COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/psfmConfig.cmake" "${PROJECT_BINARY_DIR}/psfmConfigVersion.cmake"
              "${CMAKE_CURRENT_LIST_DIR}/PsfmDependencies.cmake"
        DESTINATION "${PSFM_INSTALL_CMAKE}" COMPONENT dev)

# The program is declared later than this file is read.
function(psfm_install_program)
  if(TARGET psfm)
    install(TARGETS psfm RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT program)
  endif()
endfunction()
cmake_language(DEFER CALL psfm_install_program)
