# What a planner of someone else needs: find_package(curbstone) and curbstone::lcmtypes, or pkg-config curbstone-lcmtypes.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(programs GLOBAL PROPERTY CURBSTONE_PROGRAMS)
# All that is installed, and no tests: what a vehicle needs.
add_custom_target(programs DEPENDS ${programs} lcmtypes_headers procman_lcmtypes_headers)
if(TARGET lcmtypes_jar)
  add_dependencies(programs lcmtypes_jar)
endif()
# What scripts/demo runs, and nothing else: a third less to compile, and nothing of PCL.
add_custom_target(demo DEPENDS curbstone curbstone-deputy curbstone-lidar curbstone-imu curbstone-encoder
  curbstone-ekf curbstone-mapper curbstone-tensor-voting curbstone-semantic-map curbstone-recorder)
if(programs)
  install(TARGETS ${programs} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
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
install(DIRECTORY ${PROJECT_SOURCE_DIR}/config/ DESTINATION share/curbstone/config
  PATTERN "*.hpp" EXCLUDE PATTERN CMakeLists.txt EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/procman/ DESTINATION share/curbstone/procman FILES_MATCHING PATTERN "*.cfg")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION share/doc/curbstone)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION share/doc/curbstone FILES_MATCHING PATTERN "*.md"
  PATTERN benchmarks EXCLUDE PATTERN images EXCLUDE)
