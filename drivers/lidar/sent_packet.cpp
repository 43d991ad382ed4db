#include "drivers/lidar/sent_packet.hpp"

#include <utility>

#include "drivers/lidar/decoding/decoded_packet.hpp"
#include "drivers/lidar/decoding/point_writer.hpp"

namespace curbstone::lidar {

lidar_points_t SentPacket::message() const {
  decoding::DecodedPacket points;
  decoding::make_points(fired, points);
  lidar_points_t message{};
  message.utime = utime;
  message.packet = packet;
  message.revolution = revolution;
  message.num_points = static_cast<std::int32_t>(points.x.size());
  message.x = std::move(points.x);
  message.y = std::move(points.y);
  message.z = std::move(points.z);
  message.time_offset = std::move(points.time_offset);
  message.intensity = std::move(points.intensity);
  message.ring = std::move(points.ring);
  return message;
}

}  // namespace curbstone::lidar
