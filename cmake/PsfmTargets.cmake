# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
#
# A library holds a group of folders (docs/architecture.md, "The folders"). psfm_add_library(NAME SOURCES ...
# PUBLIC ... PRIVATE ...) makes the static library psfm_NAME with the alias psfm::NAME; psfm_add_test(NAME SOURCES ...
# LIBS ... LABELS ...) makes one GoogleTest program and registers each of its tests with ctest.

include(PsfmInstall)

set(PSFM_SANITIZE "" CACHE STRING "Sanitizers for every target, e.g. address,undefined or thread")
option(PSFM_FUZZ "Coverage for libFuzzer in every target, and the programs of tests/fuzz with it (clang)" OFF)

# Flags of our own code: never applied to anything else (INTERFACE target, linked PRIVATE).
add_library(psfm_flags INTERFACE)
target_compile_features(psfm_flags INTERFACE cxx_std_20)
# A compiler that is newer than what CI has warns of more, and sometimes wrongly: that must not keep anyone from
# building psfm.
set(PSFM_WERROR "")
if((CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13) OR
   (CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 15))
  set(PSFM_WERROR -Werror)
endif()
target_compile_options(psfm_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion ${PSFM_WERROR}
                                            -Wno-sign-conversion -fno-math-errno)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # Wrong about std::string's operator+ (GCC PR 105651), by what else is inlined beside it.
  target_compile_options(psfm_flags INTERFACE -Wno-restrict)
endif()
if(PSFM_SANITIZE)
  # -g1: functions and lines of a finding's stack, and half of what -g takes on the disk.
  target_compile_options(psfm_flags INTERFACE -fsanitize=${PSFM_SANITIZE} -fno-omit-frame-pointer -g1)
  target_link_options(psfm_flags INTERFACE -fsanitize=${PSFM_SANITIZE})
  if(PSFM_SANITIZE MATCHES "address")
    # Eigen would take aligned memory from an allocator of its own here, which Debian's Ceres, with the same templates
    # in it, frees by another one (docs/parts.md). AddressSanitizer's malloc is aligned, too.
    target_compile_definitions(psfm_flags INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  endif()
  if(PSFM_SANITIZE MATCHES "undefined")
    # Debian's OpenCV and TBB are built without typeinfo that -fsanitize=vptr needs (docs/parts.md).
    target_compile_options(psfm_flags INTERFACE -fno-sanitize=vptr -fno-sanitize-recover=undefined)
    target_link_options(psfm_flags INTERFACE -fno-sanitize=vptr)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12's diagnostics of inlined library code are wrong under sanitizers.
    target_compile_options(psfm_flags INTERFACE -Wno-maybe-uninitialized)
  endif()
endif()
if(PSFM_FUZZ)
  # Warnings are g++'s and clang-tidy's business: clang 14 has its own of what they let pass.
  target_compile_options(psfm_flags INTERFACE -fsanitize=fuzzer-no-link -fsanitize=float-cast-overflow
                                              -fno-sanitize-recover=float-cast-overflow -gline-tables-only -w)
  target_link_options(psfm_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()

# With CMAKE_UNITY_BUILD (the presets release and fuzz): most of a compilation is Eigen, Ceres and OpenCV, once for so
# many sources. The presets dev and tsan compile each by itself, so that a source includes what it uses.
set(PSFM_COMPILED_TOGETHER 70)

find_program(PSFM_CCACHE ccache)
if(PSFM_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${PSFM_CCACHE}")
  set(CMAKE_C_COMPILER_LAUNCHER "${PSFM_CCACHE}")
endif()

function(psfm_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(psfm_${name} STATIC ${ARG_SOURCES})
  add_library(psfm::${name} ALIAS psfm_${name})
  set_target_properties(psfm_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON
                        UNITY_BUILD "${PSFM_UNITY_BUILD}" UNITY_BUILD_BATCH_SIZE ${PSFM_COMPILED_TOGETHER})
  target_include_directories(psfm_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                     $<INSTALL_INTERFACE:${PSFM_INSTALL_INCLUDE}>)
  target_link_libraries(psfm_${name} PUBLIC ${ARG_PUBLIC} PRIVATE $<BUILD_INTERFACE:psfm_flags>
                                            ${ARG_PRIVATE})
  target_compile_features(psfm_${name} PUBLIC cxx_std_20)
  # What serves the tests or the program alone stays here.
  if(CMAKE_CURRENT_SOURCE_DIR MATCHES "^${PROJECT_SOURCE_DIR}/(graph|stages|storage|scheduler)")
    install(TARGETS psfm_${name} EXPORT psfmTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
            COMPONENT dev)
  endif()
endfunction()

# psfm_embed_presets(OUTPUT): a source with preset_text() (scheduler/session/presets.h), the files of scheduler/presets.
function(psfm_embed_presets output)
  file(GLOB presets CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/scheduler/presets/*.txt")
  set(cases "")
  foreach(file IN LISTS presets)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
    file(READ "${file}" text)
    cmake_path(GET file STEM LAST_ONLY name)
    string(APPEND cases "    if (name == \"${name}\") return R\"psfm(${text})psfm\";\n")
  endforeach()
  file(CONFIGURE OUTPUT "${output}" @ONLY CONTENT [[
#include "scheduler/session/presets.h"
namespace psfm {
std::optional<std::string_view> preset_text(std::string_view name) {
@cases@    return std::nullopt;
}
}  // namespace psfm
]])
endfunction()

# psfm_add_umbrella(NAME LIBRARIES...): psfm::NAME is those of the folders below, all together.
function(psfm_add_umbrella name)
  add_library(psfm_${name} INTERFACE)
  add_library(psfm::${name} ALIAS psfm_${name})
  set_target_properties(psfm_${name} PROPERTIES EXPORT_NAME ${name})
  target_link_libraries(psfm_${name} INTERFACE ${ARGN})
  install(TARGETS psfm_${name} EXPORT psfmTargets COMPONENT dev)
endfunction()

# psfm_hold_opencv_threads(NAME): under ThreadSanitizer, which does not see what OpenCV's loops hand to TBB.
function(psfm_hold_opencv_threads name)
  if(PSFM_SANITIZE MATCHES "thread")
    target_sources(${name} PRIVATE "${PROJECT_SOURCE_DIR}/tests/opencv_without_threads.cpp")
    target_link_libraries(${name} PRIVATE opencv_core opencv_imgcodecs)
  endif()
endfunction()

function(psfm_add_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LIBS;LABELS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE ${ARG_LIBS} psfm_flags GTest::gtest_main GTest::gmock)
  psfm_hold_opencv_threads(${name})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  include(GoogleTest)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT})
endfunction()
