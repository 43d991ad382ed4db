#include "tests/paths.hpp"

namespace curbstone::test {
namespace {

std::string joined(std::string_view folder, std::string_view file) {
  std::string path(folder);
  if (!file.empty()) path.append("/").append(file);
  return path;
}

}  // namespace

std::string source_path(std::string_view file) {
  return joined(CURBSTONE_SOURCE_DIR, file);
}

std::string data_path(std::string_view file) {
  return joined(CURBSTONE_SOURCE_DIR "/../shared/data", file);
}

std::string build_path(std::string_view file) {
  return joined(CURBSTONE_BUILD_DIR, file);
}

std::string program_path(std::string_view name) {
  return joined(CURBSTONE_BUILD_DIR "/bin", name);
}

}  // namespace curbstone::test
