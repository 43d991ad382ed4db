# How every target of the project is compiled: link `curbstone_options` (PRIVATE), nothing is global.
option(CURBSTONE_WERROR "Warnings are errors" OFF)
option(CURBSTONE_VEHICLE_ONLY "What runs on a vehicle or in the demo: no tests, and nothing that links PCL" OFF)
set(CURBSTONE_SANITIZE "" CACHE STRING "Sanitizers, as for -fsanitize=")

if(CURBSTONE_VEHICLE_ONLY)
  set(BUILD_TESTING OFF)
endif()
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
set(CMAKE_CXX_EXTENSIONS OFF)

add_library(curbstone_options INTERFACE)
target_compile_features(curbstone_options INTERFACE cxx_std_20)
# Everywhere alike, as LCM and GoogleTest ask for it: precompiled headers are for one set of macros.
target_compile_options(curbstone_options INTERFACE -pthread)
target_link_options(curbstone_options INTERFACE -pthread)
target_compile_options(curbstone_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wcast-align -Woverloaded-virtual
  -Wnon-virtual-dtor -Wdouble-promotion -Wformat=2
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # g++ 12 warns falsely inside std::string (GCC bug 105329)
  # The same bits on every machine: no contraction to fused multiply-add behind our back.
  -ffp-contract=off
  # A name of one file may hide one of another file of its batch. In a batch g++ 12 also warns falsely of what it
  # has inlined from std::string and std::vector; preset single, without batches, has these warnings on.
  $<$<BOOL:${CMAKE_UNITY_BUILD}>:-Wno-shadow>
  $<$<AND:$<BOOL:${CMAKE_UNITY_BUILD}>,$<CXX_COMPILER_ID:GNU>>:-Wno-array-bounds;-Wno-stringop-overflow>
  # What g++ does not warn of, and what it alone knows.
  $<$<CXX_COMPILER_ID:Clang>:-Wno-double-promotion;-Wno-bitwise-instead-of-logical;-Wno-unknown-pragmas>
  # The compiler collects its garbage beyond 1 GB only: a fifth less time where Eigen, Ceres or Beast fill its memory, which
  # is 0.2 GB more then (services/ekf/model, services/mapper/registration, services/viewer/web).
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=1048576>)
if(CURBSTONE_WERROR)
  target_compile_options(curbstone_options INTERFACE -Werror)
endif()
if(CURBSTONE_SANITIZE)
  target_compile_options(curbstone_options INTERFACE -fsanitize=${CURBSTONE_SANITIZE} -fno-omit-frame-pointer -O1)
  target_compile_definitions(curbstone_options INTERFACE CURBSTONE_SANITIZED)
  # Between a sanitizer's checks g++ 12 no longer sees that a std::optional was asked first; preset single has the warning on.
  target_compile_options(curbstone_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(curbstone_options INTERFACE -fsanitize=${CURBSTONE_SANITIZE})
  if(CURBSTONE_SANITIZE MATCHES "thread")
    # GCC's ThreadSanitizer knows no fences; Asio's guard what an executor runs, beside locks that it does know.
    target_compile_definitions(curbstone_options INTERFACE BOOST_ASIO_DISABLE_FENCED_BLOCK)
  endif()
  if(CURBSTONE_SANITIZE MATCHES "undefined")
    target_compile_options(curbstone_options INTERFACE -fno-sanitize-recover=undefined)
  endif()
endif()
