# Debian packages, for a build that is to be installed in /usr: scripts/package. See config/debian.
if(NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  return()
endif()

# Ordered by commits, and before the release that they lead to.
execute_process(COMMAND ${GIT_EXECUTABLE} rev-list --count HEAD
  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE commits OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${GIT_EXECUTABLE} log -1 --format=%aD
  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE "-" "." commit "${CURBSTONE_GIT_COMMIT}")
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}~git${commits}.${commit}")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME curbstone)
set(CPACK_PACKAGE_CONTACT "The Curbstone authors <curbstone@users.noreply.github.com>")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL vehicle tools dev)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

# After a line of summary, lines of description.
set(CPACK_DEBIAN_VEHICLE_PACKAGE_NAME curbstone)
set(CPACK_DEBIAN_VEHICLE_PACKAGE_SECTION science)
set(CPACK_COMPONENT_VEHICLE_DESCRIPTION "live map of road, curbs and obstacles for ground vehicles
 Drivers for LiDAR, IMU and wheels, odometry, dense map, tensor voting and the
 map of curbs, as programs that exchange LCM messages, and the deputy that
 starts and watches them. Installing it starts nothing.")
set(CPACK_DEBIAN_VEHICLE_PACKAGE_DEPENDS "systemd, udev, iproute2")
set(CPACK_DEBIAN_VEHICLE_PACKAGE_SUGGESTS curbstone-tools)
foreach(script postinst prerm postrm conffiles)
  list(APPEND CPACK_DEBIAN_VEHICLE_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/config/debian/${script})
endforeach()

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME curbstone-tools)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "curbs of any point cloud, export of maps, benchmarks of Curbstone
 curbstone-detect, curbstone-export, curbstone-bench, and curbstone-lcm-spy,
 which shows the messages on the bus.")
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS "curbstone (= ${CPACK_PACKAGE_VERSION})")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "default-jre, liblcm-java, libjchart2d-java")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME curbstone-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEV_DESCRIPTION "message types and tensor voting of Curbstone, for other programs
 C++ headers, the LCM types, and the CMake and pkg-config files that find them.")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "liblcm-dev, libeigen3-dev")

install(FILES config/ugv.yaml procman/ugv.cfg DESTINATION /etc/curbstone COMPONENT vehicle)

file(READ ${PROJECT_SOURCE_DIR}/LICENSE licence)
string(STRIP "${licence}" licence)
string(REGEX REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REPLACE "\n" "\n " licence "${licence}")
set(debian ${PROJECT_BINARY_DIR}/debian)
file(CONFIGURE OUTPUT ${debian}/copyright @ONLY CONTENT
"Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: Curbstone
Comment: /usr/share/doc/curbstone/licences.md has the licences of the libraries.

Files: *
Copyright: 2026 The Curbstone authors
License: BSD-3-Clause
 ${licence}
")
foreach(package curbstone curbstone-tools curbstone-dev)
  string(REGEX REPLACE "^curbstone$" "vehicle" component ${package})
  string(REPLACE "curbstone-" "" component ${component})
  file(CONFIGURE OUTPUT ${debian}/${package}/changelog @ONLY CONTENT
"${package} (${CPACK_PACKAGE_VERSION}) bookworm; urgency=medium

  * CHANGELOG.md in the source tree.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
  execute_process(COMMAND gzip -9nf ${debian}/${package}/changelog COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${debian}/copyright ${debian}/${package}/changelog.gz
    DESTINATION share/doc/${package} COMPONENT ${component})
endforeach()

include(CPack)
