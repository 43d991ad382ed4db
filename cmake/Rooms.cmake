# A room is a folder that is one library: its sources, what it may use, and nothing else.
#
#   curbstone_room(NAME [SOURCES file...] [USES room...] [PUBLIC library...] [PRIVATE library...])
#
# USES names the rooms whose headers this one may include. The list points one way: a room must be defined before it is
# used, and the compiler sees the headers of no other room, for each room's include folder holds links to its own
# headers alone (build/<preset>/rooms/<name>/<path in the source tree>). A room without sources is header-only.
# PUBLIC libraries appear in its headers, PRIVATE ones only in its sources.
function(curbstone_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;USES;PUBLIC;PRIVATE" ${ARGN})
  if(ROOM_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "room ${name}: unexpected ${ROOM_UNPARSED_ARGUMENTS}")
  endif()
  if(ROOM_SOURCES)
    add_library(${name} STATIC ${ROOM_SOURCES})
    set(scope PUBLIC)
    target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:curbstone_options>)
    curbstone_precompile(${name})
    # One batch a room: with CMake's batches of 8 files, larger rooms instantiate Eigen's templates twice.
    set_target_properties(${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 0)
  else()
    add_library(${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(curbstone::${name} ALIAS ${name})
  foreach(used ${ROOM_USES})
    if(NOT TARGET ${used})
      message(FATAL_ERROR "room ${name} uses ${used}, which is not defined yet: rooms use only what lies below them")
    endif()
  endforeach()
  curbstone_show_headers(${name} ${scope})
  target_link_libraries(${name} ${scope} ${ROOM_USES} ${ROOM_PUBLIC})
  if(ROOM_SOURCES)
    target_link_libraries(${name} PRIVATE ${ROOM_PRIVATE})
  endif()
endfunction()

# The include folder of a room: a link to each header of the folder that this is called in.
function(curbstone_show_headers name scope)
  set(shown ${PROJECT_BINARY_DIR}/rooms/${name})
  file(RELATIVE_PATH path ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.hpp *.cuh)
  file(GLOB links RELATIVE ${shown}/${path} ${shown}/${path}/*)
  foreach(link ${links})
    if(NOT link IN_LIST headers)
      file(REMOVE ${shown}/${path}/${link})
    endif()
  endforeach()
  file(MAKE_DIRECTORY ${shown}/${path})
  foreach(header ${headers})
    if(NOT EXISTS ${shown}/${path}/${header})
      file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR}/${header} ${shown}/${path}/${header} SYMBOLIC)
    endif()
  endforeach()
  target_include_directories(${name} ${scope}
    $<BUILD_INTERFACE:${shown}> $<INSTALL_INTERFACE:include/curbstone>)
endfunction()

# curbstone_program(NAME sources... [USES library...]): builds bin/<name>, installed.
function(curbstone_program name)
  cmake_parse_arguments(PROGRAM "" "" "USES" ${ARGN})
  add_executable(${name} ${PROGRAM_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PRIVATE curbstone_options ${PROGRAM_USES})
  curbstone_precompile(${name})
  set_property(GLOBAL APPEND PROPERTY CURBSTONE_PROGRAMS ${name})
endfunction()
