#pragma once

#include <curbstone/map_pose_t.hpp>
#include <string>

#include "common/config/vehicle.hpp"

namespace curbstone::viewer::foxglove {

/// Makes a foxglove.FrameTransforms, as protobuf: map to odom to base_link at the time of the pose, and base_link to
/// lidar and imu as mounted. Each message holds all of them, so a viewer that starts anywhere has the whole tree. The
/// pose must be finite.
[[nodiscard]] std::string transforms_message(const map_pose_t& pose, const VehicleConfig& vehicle);
/// foxglove.PoseInFrame: base_link in map.
[[nodiscard]] std::string pose_message(const map_pose_t& pose);

}  // namespace curbstone::viewer::foxglove
