#include "services/viewer/foxglove/point_message.hpp"

#include <foxglove/packed.pb.h>

#include <array>
#include <bit>
#include <span>

#include "common/bytes/little_endian.hpp"
#include "services/viewer/foxglove/message_parts.hpp"

namespace curbstone::viewer::foxglove {
namespace {

constexpr std::size_t kPointBytes = 16;

void append(std::string& bytes, float value) {
  std::array<std::uint8_t, 4> number{};
  write_little_endian(std::span<std::uint8_t>(number), std::bit_cast<std::uint32_t>(value));
  bytes.append(reinterpret_cast<const char*>(number.data()), number.size());
}

}  // namespace

std::string point_message(const std::vector<CloudPoint>& points, const std::string& frame, std::int64_t utime) {
  ::foxglove::PointCloud cloud;
  set_time(*cloud.mutable_timestamp(), utime);
  cloud.set_frame_id(frame);
  set_pose(*cloud.mutable_pose(), Pose::Identity());
  cloud.set_point_stride(kPointBytes);
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z", "intensity"}) {
    add_field(cloud, name, offset, ::foxglove::PackedElementField::FLOAT32);
    offset += 4;
  }
  std::string& bytes = *cloud.mutable_data();
  bytes.reserve(points.size() * kPointBytes);
  for (const CloudPoint& point : points) {
    for (const float value : {point.x, point.y, point.z, point.intensity}) append(bytes, value);
  }
  return cloud.SerializeAsString();
}

std::string scan_message(const std::vector<frames::ScanPoint>& points, std::int64_t utime) {
  const auto metres = [](std::int16_t cm) { return static_cast<float>(cm) * 0.01F; };
  std::vector<CloudPoint> cloud;
  cloud.reserve(points.size());
  for (const auto& p : points)
    cloud.push_back({metres(p.x), metres(p.y), metres(p.z), static_cast<float>(p.intensity)});
  return point_message(cloud, "base_link", utime);
}

}  // namespace curbstone::viewer::foxglove
