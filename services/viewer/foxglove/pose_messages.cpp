#include "services/viewer/foxglove/pose_messages.hpp"

#include <foxglove/frames.pb.h>

#include "common/geometry/geometry.hpp"
#include "services/viewer/foxglove/message_parts.hpp"

namespace curbstone::viewer::foxglove {
namespace {

void add(::foxglove::FrameTransforms& to, std::int64_t utime, const std::string& parent, const std::string& child,
         const Pose& T_parent_child) {
  auto& transform = *to.add_transforms();
  set_time(*transform.mutable_timestamp(), utime);
  transform.set_parent_frame_id(parent);
  transform.set_child_frame_id(child);
  const Eigen::Vector3d& t = T_parent_child.translation();
  set_vector(*transform.mutable_translation(), t.x(), t.y(), t.z());
  set_rotation(*transform.mutable_rotation(), T_parent_child);
}

}  // namespace

std::string transforms_message(const map_pose_t& pose, const VehicleConfig& vehicle) {
  const Pose T_map_base = pose_from_arrays(pose.map_base_position, pose.map_base_orientation);
  Pose T_map_odom = pose_from_arrays(pose.map_odom_position, pose.map_odom_orientation);
  if (!is_finite(T_map_odom)) T_map_odom = Pose::Identity();  // the mapper runs without odometry
  ::foxglove::FrameTransforms message;
  add(message, pose.utime, "map", "odom", T_map_odom);
  add(message, pose.utime, "odom", "base_link", T_map_odom.inverse() * T_map_base);
  add(message, pose.utime, "base_link", "lidar", vehicle.T_base_lidar());
  add(message, pose.utime, "base_link", "imu", vehicle.T_base_imu());
  return message.SerializeAsString();
}

std::string pose_message(const map_pose_t& pose) {
  ::foxglove::PoseInFrame message;
  set_time(*message.mutable_timestamp(), pose.utime);
  message.set_frame_id("map");
  set_pose(*message.mutable_pose(), pose_from_arrays(pose.map_base_position, pose.map_base_orientation));
  return message.SerializeAsString();
}

}  // namespace curbstone::viewer::foxglove
