#pragma once

#include <curbstone/map_pose_t.hpp>
#include <string>

#include "common/config/vehicle.hpp"

namespace curbstone::viewer::foxglove {

/// foxglove.FrameTransforms, as protobuf: map to odom to base_link at the pose's time, base_link to lidar and imu as
/// mounted. All in each message, so that a viewer that begins anywhere has the whole tree. The pose must be finite.
[[nodiscard]] std::string transforms_message(const map_pose_t& pose, const VehicleConfig& vehicle);
/// foxglove.PoseInFrame: base_link in map.
[[nodiscard]] std::string pose_message(const map_pose_t& pose);

}  // namespace curbstone::viewer::foxglove
