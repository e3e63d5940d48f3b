# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
#
# `cpack` in a release build makes two Debian packages: psfm, the program with its manual pages, completions and
# documents, and libpsfm-dev, the libraries and headers. Build on the release that they are for: what they depend on is
# read from the program itself (dpkg-shlibdeps). tools/package/make-packages does all of it.
option(PSFM_MANUALS "Manual pages and completions, made by running psfm, and its service are installed, too" OFF)

set(CPACK_PACKAGE_CONTACT "the psfm authors <psfm@localhost>")

set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
if(EXISTS /etc/os-release)
  file(STRINGS /etc/os-release id REGEX "^ID=")
  file(STRINGS /etc/os-release version REGEX "^VERSION_ID=")
  string(REGEX REPLACE "[A-Z_=\"]" "" release "${id}${version}")
  set(CPACK_DEBIAN_PACKAGE_RELEASE "1~${release}")  # 1~debian12
endif()

if(PSFM_MANUALS)
  find_package(Python3 COMPONENTS Interpreter REQUIRED)
  set(PSFM_MANUAL_FOLDER "${PROJECT_BINARY_DIR}/manuals")
  add_custom_command(OUTPUT "${PSFM_MANUAL_FOLDER}/bash/psfm"
    COMMAND Python3::Interpreter "${PROJECT_SOURCE_DIR}/tools/package/make-manuals" "$<TARGET_FILE:psfm>"
            "${PSFM_MANUAL_FOLDER}"
    DEPENDS psfm "${PROJECT_SOURCE_DIR}/tools/package/make-manuals" VERBATIM)
  add_custom_target(psfm_manuals ALL DEPENDS "${PSFM_MANUAL_FOLDER}/bash/psfm")
  # Debian wants them compressed, with nothing in them that differs from build to build.
  install(CODE "file(REMOVE_RECURSE \"${PSFM_MANUAL_FOLDER}/gz\")
file(COPY \"${PSFM_MANUAL_FOLDER}/man1\" DESTINATION \"${PSFM_MANUAL_FOLDER}/gz\")
file(GLOB pages \"${PSFM_MANUAL_FOLDER}/gz/man1/*.1\")
execute_process(COMMAND gzip -9n \${pages} COMMAND_ERROR_IS_FATAL ANY)" COMPONENT program)
  install(DIRECTORY "${PSFM_MANUAL_FOLDER}/gz/man1" DESTINATION "${CMAKE_INSTALL_MANDIR}" COMPONENT program)
  install(FILES "${PSFM_MANUAL_FOLDER}/bash/psfm" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions"
          COMPONENT program)
  install(FILES "${PSFM_MANUAL_FOLDER}/zsh/_psfm" DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions"
          COMPONENT program)
  # The server as a service: it starts /usr/bin/psfm, as the user that tools/package/postinst makes.
  install(FILES "${PROJECT_SOURCE_DIR}/tools/package/psfm.service" DESTINATION lib/systemd/system COMPONENT program)
  # What Debian wants of every package: whose it is, and what has changed, as of the commit's day (SOURCE_DATE_EPOCH).
  set(debian_folder "${PROJECT_BINARY_DIR}/debian")
  file(READ "${PROJECT_SOURCE_DIR}/LICENSE" license)
  string(REGEX REPLACE "\n\n" "\n.\n" license "${license}")
  string(REGEX REPLACE "\n(.)" "\n \\1" license "${license}")
  file(WRITE "${debian_folder}/copyright" "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: psfm

Files: *
Copyright: 2026 the psfm authors
License: BSD-3-Clause

License: BSD-3-Clause
 ${license}")
  string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
  file(WRITE "${debian_folder}/changelog.Debian" "psfm (${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; \
urgency=medium

  * As /usr/share/doc/psfm/changelog.gz has it.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
  file(COPY_FILE "${PROJECT_SOURCE_DIR}/CHANGELOG.md" "${debian_folder}/changelog")
  execute_process(COMMAND gzip -9nf changelog.Debian changelog WORKING_DIRECTORY "${debian_folder}"
                  COMMAND_ERROR_IS_FATAL ANY)
  set(debian_files "${debian_folder}/copyright" "${debian_folder}/changelog.Debian.gz" "${debian_folder}/changelog.gz")
  install(FILES ${debian_files} DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/psfm" COMPONENT program)
  install(FILES ${debian_files} DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/libpsfm-dev" COMPONENT dev)
endif()
# Documents, at the places that they link to each other by (tests/house/documents_test.py).
install(FILES "${PROJECT_SOURCE_DIR}/README.md" "${PROJECT_SOURCE_DIR}/CHANGELOG.md"
        DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
foreach(document IN ITEMS storage/FORMAT.md stages/retrieval/VOCABULARY_FORMAT.md)
  get_filename_component(folder "${document}" DIRECTORY)
  install(FILES "${PROJECT_SOURCE_DIR}/${document}" DESTINATION "${CMAKE_INSTALL_DOCDIR}/${folder}" COMPONENT program)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME psfm)
set(CPACK_PACKAGE_VENDOR "the psfm authors")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${CPACK_PACKAGE_CONTACT}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program dev)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME psfm)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# passwd: postinst's useradd, which Ubuntu's smallest systems lack; libheif's decoder of HEIC is a package of its own
# since 1.16, which libheif1 need not bring.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "passwd, libheif-plugin-libde265 | libheif1 (<< 1.16)")
# Without it focal lengths of some cameras stay unknown.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS liblensfun-data-v1)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_EXTRA "${PROJECT_SOURCE_DIR}/tools/package/postinst"
                                               "${PROJECT_SOURCE_DIR}/tools/package/prerm"
                                               "${PROJECT_SOURCE_DIR}/tools/package/postrm")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "progressive Structure from Motion
Photographs in, camera poses and a sparse 3D model out, while they arrive:
after every image there is a current model, stored, exportable, and open to
revision. Exports for COLMAP, Gaussian splatting and multi-view stereo.")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libpsfm-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
string(JOIN ", " CPACK_DEBIAN_DEV_PACKAGE_DEPENDS libeigen3-dev libceres-dev libsuitesparse-dev libopenblas-dev
       libtbb-dev libopencv-dev libflann-dev libexiv2-dev liblensfun-dev libglib2.0-dev libgeographiclib-dev
       libheif-dev libjpeg-dev librocksdb-dev libflatbuffers-dev libxxhash-dev libsqlite3-dev nlohmann-json3-dev
       pkg-config)
set(CPACK_COMPONENT_DEV_DESCRIPTION "progressive Structure from Motion, libraries
Static libraries, headers and a CMake package (find_package(psfm CONFIG)) of
the stages, the session store and the flow graph of psfm.")
include(CPack)
