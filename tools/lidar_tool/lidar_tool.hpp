#pragma once

namespace curbstone::lidar_tool {

/// `curbstone lidar info|csv|pcd|watch`. Returns the exit status.
int run_lidar(int argc, char** argv);

}  // namespace curbstone::lidar_tool
