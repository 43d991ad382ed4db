// A point cloud's file: PLY, or PCD.
#include <cstring>
#include <stdexcept>

#include "tests/fuzz/support/memory_file.hpp"
#include "tools/detect/pcd_file.hpp"
#include "tools/detect/ply_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  const fuzz::MemoryFile file({data, size});
  const bool is_ply = size >= 3 && std::memcmp(data, "ply", 3) == 0;
  try {
    if (is_ply) {
      fuzz::require(12 * detect::read_ply(file.name(), {1, 2, 3}).size() <= 2 * size, "a vertex has three numbers");
    } else {
      fuzz::require(detect::read_pcd(file.name(), {1, 2, 3}).size() <= 200 * size, "a point takes bytes");
    }
  } catch (const std::runtime_error&) {
    // Not such a file, and said so.
  }
  return 0;
}
