#pragma once

#include <foxglove/geometry.pb.h>
#include <foxglove/packed.pb.h>
#include <google/protobuf/timestamp.pb.h>

#include <cstdint>
#include <string>

#include "common/geometry/geometry.hpp"

namespace curbstone::viewer::foxglove {

/// Parts shared by several of the Foxglove messages. Include it only in .cpp files of this room: the protobuf headers
/// are large.

/// `utime`: us since the Unix epoch.
inline void set_time(google::protobuf::Timestamp& to, std::int64_t utime) {
  to.set_seconds(utime / 1'000'000);
  to.set_nanos(static_cast<std::int32_t>(utime % 1'000'000 * 1000));
}

template <class Vector>
void set_vector(Vector& to, double x, double y, double z) {
  to.set_x(x);
  to.set_y(y);
  to.set_z(z);
}

inline void set_rotation(::foxglove::Quaternion& to, const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  to.set_x(q.x());
  to.set_y(q.y());
  to.set_z(q.z());
  to.set_w(q.w());
}

inline void set_pose(::foxglove::Pose& to, const Pose& pose) {
  set_vector(*to.mutable_position(), pose.translation().x(), pose.translation().y(), pose.translation().z());
  set_rotation(*to.mutable_orientation(), pose);
}

/// Adds a field to a grid or a cloud.
template <class Packed>
void add_field(Packed& to, const std::string& name, std::uint32_t offset,
               ::foxglove::PackedElementField::NumericType type) {
  auto& field = *to.add_fields();
  field.set_name(name);
  field.set_offset(offset);
  field.set_type(type);
}

}  // namespace curbstone::viewer::foxglove
