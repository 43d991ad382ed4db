# What is installed, and into which package it goes (cmake/Package.cmake): component `vehicle` what runs on one, `tools`
# what looks at its maps, `dev` the rest: what a planner of someone else needs, by find_package(curbstone) and
# curbstone::lcmtypes, or by pkg-config curbstone-lcmtypes.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(programs GLOBAL PROPERTY CURBSTONE_PROGRAMS)
# All that is installed, and no tests: what a vehicle needs.
add_custom_target(programs DEPENDS ${programs} lcmtypes_headers procman_lcmtypes_headers)
if(TARGET lcmtypes_jar)
  add_dependencies(programs lcmtypes_jar)
endif()
# What scripts/demo runs, and nothing else: half of the whole to compile, and nothing of PCL. With a saved map, and to
# keep the page open at the end, it builds what it runs more.
add_custom_target(demo DEPENDS curbstone curbstone-deputy curbstone-lidar curbstone-imu curbstone-encoder
  curbstone-ekf curbstone-mapper curbstone-tensor-voting curbstone-semantic-map curbstone-recorder curbstone-viewer)
if(NOT CURBSTONE_VEHICLE_ONLY)
  set(tools curbstone-bench curbstone-detect curbstone-export)
  list(REMOVE_ITEM programs ${tools})
  install(TARGETS ${tools} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tools)
endif()
install(TARGETS ${programs} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT vehicle)
install(PROGRAMS scripts/lcm-spy DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME curbstone-lcm-spy COMPONENT tools)

install(DIRECTORY ${PROJECT_BINARY_DIR}/lcmtypes/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS lcmtypes procman_lcmtypes EXPORT curbstoneTargets)
install(EXPORT curbstoneTargets NAMESPACE curbstone:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/curbstone)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/curbstoneConfig.cmake.in
  ${PROJECT_BINARY_DIR}/curbstoneConfig.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/curbstone)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/curbstoneConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/curbstoneConfig.cmake ${PROJECT_BINARY_DIR}/curbstoneConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/curbstone)
# Relative to where the .pc file lies: the installation can be moved.
file(RELATIVE_PATH CURBSTONE_PC_PREFIX /x/${CMAKE_INSTALL_LIBDIR}/pkgconfig /x)
configure_file(${PROJECT_SOURCE_DIR}/cmake/curbstone-lcmtypes.pc.in ${PROJECT_BINARY_DIR}/curbstone-lcmtypes.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/curbstone-lcmtypes.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# The vehicle's files as they come. /etc/curbstone has those that are edited: a package puts them there, and keeps them.
install(FILES config/ugv.yaml procman/ugv.cfg DESTINATION share/curbstone COMPONENT vehicle)
install(FILES config/foxglove/curbstone.json DESTINATION share/curbstone/foxglove COMPONENT tools)
install(FILES config/sysctl.d/60-curbstone.conf DESTINATION lib/sysctl.d COMPONENT vehicle)
install(FILES config/udev/60-curbstone.rules DESTINATION lib/udev/rules.d COMPONENT vehicle)
install(FILES config/sysusers.d/curbstone.conf DESTINATION lib/sysusers.d COMPONENT vehicle)
install(FILES config/tmpfiles.d/curbstone.conf DESTINATION lib/tmpfiles.d COMPONENT vehicle)
# The units in the tree are for /usr/local.
foreach(unit curbstone-deputy curbstone-network)
  set(file ${PROJECT_SOURCE_DIR}/config/systemd/${unit}.service)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  string(REPLACE "/usr/local/" "${CMAKE_INSTALL_PREFIX}/" text "${text}")
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/systemd/${unit}.service CONTENT "${text}" @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/systemd/${unit}.service DESTINATION lib/systemd/system COMPONENT vehicle)
endforeach()
install(FILES LICENSE DESTINATION share/doc/curbstone COMPONENT vehicle)
install(DIRECTORY docs/ DESTINATION share/doc/curbstone COMPONENT vehicle FILES_MATCHING PATTERN "*.md"
  PATTERN benchmarks EXCLUDE PATTERN images EXCLUDE)
