#include "drivers/lidar/lidar_node.hpp"

#include <algorithm>
#include <cmath>

#include "common/time/microseconds.hpp"
#include "drivers/lidar/packet/rs16_packet.hpp"

namespace curbstone::lidar {

namespace {

/// One second of packets at 20 Hz.
constexpr std::size_t kLatencies = 750;

bool is_device_info(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 2 && bytes[0] == packet::kDifopMagic[0] && bytes[1] == packet::kDifopMagic[1];
}

}  // namespace

LidarNode::LidarNode(const LidarConfig& config, Publisher& bus)
    : config_(config),
      bus_(bus),
      decoder_({config.min_range, config.max_range}),
      clock_(config.clock, microseconds(config.clock_tolerance)),
      head_(static_cast<int>(std::lround(config.cut_angle * 100))),
      health_(config.msop_port, config.difop_port),
      latency_(kLatencies) {
  packet::DeviceInfo device;
  device.distance_step = distance_step(config.distance_resolution).value_or(device.distance_step);
  decoder_.set_device(device);
  message_.packet = -1;
}

void LidarNode::on(const raw_packet_t& packet) {
  on_packet(packet.utime, packet.port, packet.data);
}

void LidarNode::on_packet(std::int64_t received, int port, std::span<const std::uint8_t> bytes) {
  if (config_.publish_raw) publish_raw(received, port, bytes);
  const packet::Refusal refusal = is_device_info(bytes) ? on_device_info(bytes) : on_points(received, bytes);
  if (refusal == packet::Refusal::kNone) return;
  counters_.add(packet::counter_of(refusal));
  health_.packet_refused(refusal);
}

packet::Refusal LidarNode::on_device_info(std::span<const std::uint8_t> bytes) {
  packet::DifopResult result = packet::parse_difop(bytes);
  if (result.refusal != packet::Refusal::kNone) return result.refusal;
  counters_.add("difop");
  health_.info_packet_used();
  result.info.distance_step = distance_step(config_.distance_resolution).value_or(result.info.distance_step);
  if (result.info != decoder_.device()) decoder_.set_device(result.info);
  return packet::Refusal::kNone;
}

packet::Refusal LidarNode::on_points(std::int64_t received, std::span<const std::uint8_t> bytes) {
  if (const packet::Refusal refusal = decoder_.decode(bytes, packet_); refusal != packet::Refusal::kNone)
    return refusal;
  if (!packet_.stamp) counters_.add("clock.invalid");
  const decoding::PacketClock::Time time = clock_.time_of(packet_.stamp, received, microseconds(packet_.duration));
  if (const packet::Refusal refusal = follow_head(time); refusal != packet::Refusal::kNone) return refusal;
  publish_points(received, time.utime);
  return packet::Refusal::kNone;
}

packet::Refusal LidarNode::follow_head(const decoding::PacketClock::Time& time) {
  const double blind = (360.0 - decoder_.device().fov) * 100.0;
  const decoding::HeadTracker::Step step =
      head_.follow({time.even, packet_.azimuth, packet_.rate, packet_.duration}, blind);
  if (step.duplicate) return packet::Refusal::kDuplicate;
  if (step.late) return packet::Refusal::kLate;
  if (step.lost > 0) counters_.add("lost.packets", step.lost);
  message_.revolution = step.revolution;
  return packet::Refusal::kNone;
}

void LidarNode::publish_points(std::int64_t received, std::int64_t utime) {
  message_.utime = utime;
  ++message_.packet;
  message_.num_points = static_cast<std::int32_t>(packet_.x.size());
  // The vectors go back and forth between packet and message, and are allocated once.
  message_.x.swap(packet_.x);
  message_.y.swap(packet_.y);
  message_.z.swap(packet_.z);
  message_.time_offset.swap(packet_.time_offset);
  message_.intensity.swap(packet_.intensity);
  message_.ring.swap(packet_.ring);
  bus_.publish("LIDAR_POINTS", message_);

  counters_.add("packets");
  counters_.add("points", message_.num_points);
  if (packet_.out_of_range > 0) counters_.add("out_of_range", packet_.out_of_range);
  latency_.add(static_cast<double>(received - utime) * 1e-6);
  health_.point_packet_used();
}

void LidarNode::publish_raw(std::int64_t received, int port, std::span<const std::uint8_t> bytes) {
  if (bytes.size() > 2 * packet::kRs16PacketSize) return;
  raw_packet_t raw;
  raw.utime = received;
  raw.port = port;
  raw.size = static_cast<std::int32_t>(bytes.size());
  raw.data.assign(bytes.begin(), bytes.end());
  bus_.publish("LIDAR_RAW", raw);
}

NodeReport LidarNode::report() const {
  NodeReport report;
  report.counters = counters_;
  report.counters.set("revolutions", message_.packet < 0 ? 0 : message_.revolution + 1);
  report.counters.set("clock.device", clock_.uses_device() ? 1 : 0);
  report.counters.set("clock.switches", clock_.switches());
  report.counters.set("clock.jumps", clock_.jumps());
  report.faults = health_.faults();
  if (config_.clock == decoding::ClockMode::kDevice &&
      std::abs(clock_.last_difference()) > microseconds(config_.clock_tolerance))
    report.faults.push_back("the device's clock is not set: use clock: auto or host, or connect its GPS");
  report.latency_p50 = latency_.percentile(0.5);
  report.latency_p99 = latency_.percentile(0.99);
  return report;
}

}  // namespace curbstone::lidar
