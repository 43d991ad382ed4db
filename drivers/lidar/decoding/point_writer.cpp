#include "drivers/lidar/decoding/point_writer.hpp"

namespace curbstone::lidar::decoding {

namespace {

template <class Value>
Value* room_for_all(std::vector<Value>& values) {
  values.resize(PointWriter::kMost);
  return values.data();
}

}  // namespace

PointWriter::PointWriter(const ReturnLimits& limits, double lens_offset, DecodedPacket& packet)
    : limits_(limits),
      lens_offset_(lens_offset),
      whole_turn_(std::fmod(limits.end_angle - limits.start_angle, 360.0) == 0.0),
      packet_(packet),
      x_(room_for_all(packet.x)),
      y_(room_for_all(packet.y)),
      z_(room_for_all(packet.z)),
      time_(room_for_all(packet.time_offset)),
      intensity_(room_for_all(packet.intensity)),
      ring_(room_for_all(packet.ring)) {}

void PointWriter::finish() {
  for (auto* values : {&packet_.x, &packet_.y, &packet_.z, &packet_.time_offset}) values->resize(count_);
  packet_.intensity.resize(count_);
  packet_.ring.resize(count_);
}

bool PointWriter::in_sector(double azimuth_deg) const {
  const auto turned = [&](double angle) {
    const double from_start = std::fmod(angle - limits_.start_angle, 360.0);
    return from_start < 0 ? from_start + 360.0 : from_start;
  };
  return turned(azimuth_deg) < turned(limits_.end_angle);
}

}  // namespace curbstone::lidar::decoding
