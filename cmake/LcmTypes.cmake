# lcm_types(NAME <target> PACKAGE <package> FILES a.lcm b.lcm ...): C++ headers of one LCM package as an INTERFACE
# library, SYSTEM so that the generated code is not held to our warnings. Include as <package/type.hpp>.
find_program(LCM_GEN lcm-gen REQUIRED)

function(lcm_types)
  cmake_parse_arguments(ARG "" "NAME;PACKAGE" "FILES" ${ARGN})
  set(dir ${PROJECT_BINARY_DIR}/lcmtypes/include)
  set(headers)
  foreach(file ${ARG_FILES})
    get_filename_component(type ${file} NAME_WE)
    set(header ${dir}/${ARG_PACKAGE}/${type}.hpp)
    add_custom_command(OUTPUT ${header}
      COMMAND ${LCM_GEN} --cpp --cpp-hpath ${dir} ${file}
      # lcm-gen 1.3.1 believes an array length off the wire: it resizes to it (gigabytes), and its check of the bytes
      # overflows (reads past the end). No element is smaller than a byte. It believes a string's length, too: one of
      # -2^31 is read as 2 GiB. A string ends with a 0, and has no other: else it could not be sent on.
      COMMAND sed -i -E
        -e "s/^( *)(this->.*)[.]resize[(](.*)[)]\;/\\1if ((\\3) < 0 || (\\3) > maxlen - pos) return -1\;\\n&/"
        -e "s/if[(](__.*_len_*) > maxlen - pos[)] return -1\;/if (\\1 < 1 || \\1 > maxlen - pos || memchr((const char*)buf + offset + pos, 0, \\1) != (const char*)buf + offset + pos + \\1 - 1) return -1\;/"
        ${header}
      DEPENDS ${file} COMMENT "lcm-gen ${ARG_PACKAGE}.${type}" VERBATIM)
    list(APPEND headers ${header})
  endforeach()
  add_custom_target(${ARG_NAME}_headers DEPENDS ${headers})
  add_library(${ARG_NAME} INTERFACE)
  add_library(curbstone::${ARG_NAME} ALIAS ${ARG_NAME})
  add_dependencies(${ARG_NAME} ${ARG_NAME}_headers)
  target_include_directories(${ARG_NAME} SYSTEM INTERFACE $<BUILD_INTERFACE:${dir}> $<INSTALL_INTERFACE:include>)
  target_link_libraries(${ARG_NAME} INTERFACE $<BUILD_INTERFACE:PkgConfig::LCM>)
endfunction()

# lcm_types_jar(NAME <target> OUTPUT <jar> FILES ...): the same types for lcm-spy and other Java programs.
# Skipped, with a word, where there is no Java compiler.
function(lcm_types_jar)
  cmake_parse_arguments(ARG "" "NAME;OUTPUT" "FILES" ${ARGN})
  find_program(JAVAC javac)
  find_program(JAR jar)
  find_file(LCM_JAR lcm.jar PATHS /usr/share/java /usr/local/share/java)
  if(NOT (JAVAC AND JAR AND LCM_JAR))
    message(STATUS "No javac, jar or lcm.jar: ${ARG_OUTPUT} is not built (lcm-spy will not decode our types)")
    return()
  endif()
  set(dir ${PROJECT_BINARY_DIR}/lcmtypes/java)
  set(jar ${PROJECT_BINARY_DIR}/share/java/${ARG_OUTPUT})
  set(script ${CMAKE_CURRENT_BINARY_DIR}/${ARG_NAME}.sh)
  list(JOIN ARG_FILES "' '" files)
  file(WRITE ${script} "set -e\nrm -rf '${dir}'\nmkdir -p '${dir}/classes' '${PROJECT_BINARY_DIR}/share/java'\n"
    "'${LCM_GEN}' --java --jpath '${dir}' '${files}'\n"
    "'${JAVAC}' -nowarn -encoding UTF-8 -cp '${LCM_JAR}' -d '${dir}/classes' $(find '${dir}' -name '*.java')\n"
    "'${JAR}' cf '${jar}' -C '${dir}/classes' .\n")
  add_custom_command(OUTPUT ${jar} COMMAND sh ${script} DEPENDS ${ARG_FILES} ${script} COMMENT "${ARG_OUTPUT}" VERBATIM)
  add_custom_target(${ARG_NAME} ALL DEPENDS ${jar})
  install(FILES ${jar} DESTINATION share/java COMPONENT tools)
endfunction()
