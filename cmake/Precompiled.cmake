# What most files include, compiled once: Eigen and the standard library, and GoogleTest for the tests. Preset single
# does without in the rooms, so that each file includes what it uses.
option(CURBSTONE_PCH "Precompile the headers that most files include" OFF)
set(curbstone_common_headers
  <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <chrono> <cmath> <cstdint> <deque> <functional> <limits> <map>
  <memory> <optional> <set> <span> <stdexcept> <string> <string_view> <unordered_map> <utility> <variant> <vector>)

# curbstone_precompiled_set(NAME DIR headers...): a set that targets of the same compile options can use.
function(curbstone_precompiled_set name)
  file(WRITE ${PROJECT_BINARY_DIR}/${name}.cpp.new "// Carries ${name}.\n")
  file(COPY_FILE ${PROJECT_BINARY_DIR}/${name}.cpp.new ${PROJECT_BINARY_DIR}/${name}.cpp ONLY_IF_DIFFERENT)
  add_library(${name} OBJECT ${PROJECT_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE curbstone_options Eigen3::Eigen)
  target_compile_options(${name} PRIVATE -fpch-preprocess)  # for ccache
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()

if(CURBSTONE_PCH)
  curbstone_precompiled_set(curbstone_pch ${curbstone_common_headers})
endif()

# Lets a room use the set. Files with instruction sets of their own do without (SKIP_PRECOMPILE_HEADERS).
function(curbstone_precompile target)
  if(CURBSTONE_PCH)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:Eigen3::Eigen>)
    target_compile_options(${target} PRIVATE -fpch-preprocess)
    target_precompile_headers(${target} REUSE_FROM curbstone_pch)
  endif()
endfunction()
