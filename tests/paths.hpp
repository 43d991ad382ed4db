#pragma once

#include <string>
#include <string_view>

/// Where things lie on this machine. The paths are compiled into one library: in the command line of every test they
/// would make the compiler's cache (ccache) useless in any other folder.
namespace curbstone::test {

/// A file of the source tree, as source_path("config/ugv.yaml").
std::string source_path(std::string_view file);

/// A recording in ../shared/data, which is never shipped: a test that reads one skips where it is absent.
std::string data_path(std::string_view file);

/// A file or folder of the build, as build_path("tests/foxglove").
std::string build_path(std::string_view file);

/// A program as it was built, as program_path("curbstone-lidar"); the folder of all of them for "".
std::string program_path(std::string_view name);

}  // namespace curbstone::test
