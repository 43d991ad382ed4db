// The file with the angles of a LiDAR's lasers.
#include <cmath>
#include <stdexcept>

#include "drivers/lidar/angles_file.hpp"
#include "tests/fuzz/support/memory_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  const fuzz::MemoryFile file({data, size});
  try {
    for (const lidar::models::LaserAngles& laser : lidar::read_angles(file.name()))
      fuzz::require(std::isfinite(laser.elevation) && std::isfinite(laser.azimuth), "angles are finite");
  } catch (const std::runtime_error&) {
    // Not such a file, and said so.
  }
  return 0;
}
