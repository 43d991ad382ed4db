#include "drivers/lidar/decoding/point_writer.hpp"

#include <cmath>
#include <numbers>

namespace curbstone::lidar::decoding {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

PointWriter::PointWriter(const ReturnLimits& limits, double lens_offset)
    : limits_(limits),
      lens_offset_(lens_offset),
      whole_turn_(std::fmod(limits.end_angle - limits.start_angle, 360.0) == 0.0) {}

bool PointWriter::in_sector(double azimuth_deg) const {
  const auto turned = [&](double angle) {
    const double from_start = std::fmod(angle - limits_.start_angle, 360.0);
    return from_start < 0 ? from_start + 360.0 : from_start;
  };
  return turned(azimuth_deg) < turned(limits_.end_angle);
}

void PointWriter::add(double azimuth_deg, double time, const Laser& laser, double range, std::uint8_t intensity,
                      DecodedPacket& packet) const {
  if (range < limits_.min_range || range > limits_.max_range) {
    ++packet.out_of_range;
    return;
  }
  const double beam_deg = azimuth_deg + laser.azimuth;
  if (!whole_turn_ && !in_sector(beam_deg)) return;
  const double azimuth = azimuth_deg * kDegree;
  if (laser.azimuth == 0) {
    const double outward = range * laser.cos + lens_offset_;
    packet.x.push_back(static_cast<float>(outward * std::cos(azimuth)));
    packet.y.push_back(static_cast<float>(-outward * std::sin(azimuth)));
  } else {
    const double beam = beam_deg * kDegree;
    packet.x.push_back(static_cast<float>(range * laser.cos * std::cos(beam) + lens_offset_ * std::cos(azimuth)));
    packet.y.push_back(static_cast<float>(-range * laser.cos * std::sin(beam) - lens_offset_ * std::sin(azimuth)));
  }
  packet.z.push_back(static_cast<float>(range * laser.sin + laser.height));
  packet.time_offset.push_back(static_cast<float>(time));
  packet.intensity.push_back(intensity);
  packet.ring.push_back(laser.ring);
}

}  // namespace curbstone::lidar::decoding
