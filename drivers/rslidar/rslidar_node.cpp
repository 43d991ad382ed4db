#include "drivers/rslidar/rslidar_node.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/rslidar/rs16_packet.hpp"

namespace curbstone {

namespace {

/// One second of packets at 20 Hz.
constexpr std::size_t kLatencies = 750;

bool is_device_info(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 2 && bytes[0] == kDifopMagic[0] && bytes[1] == kDifopMagic[1];
}

std::int64_t microseconds(double seconds) {
  return std::llround(seconds * 1e6);
}

}  // namespace

RslidarNode::RslidarNode(const RslidarConfig& config, Publisher& bus)
    : config_(config),
      bus_(bus),
      decoder_({config.min_range, config.max_range}),
      clock_(config.clock, microseconds(config.clock_tolerance)),
      head_(static_cast<int>(std::lround(config.cut_angle * 100))),
      health_(config.msop_port, config.difop_port),
      latency_(kLatencies) {
  DeviceInfo device;
  if (config.distance_resolution == "0.01") device.distance_step = 0.01;
  decoder_.set_device(device);
  message_.packet = -1;
}

void RslidarNode::on(const raw_packet_t& packet) {
  on_packet(packet.utime, packet.port, packet.data);
}

void RslidarNode::on_packet(std::int64_t received, int port, std::span<const std::uint8_t> bytes) {
  if (config_.publish_raw) publish_raw(received, port, bytes);
  const Refusal refusal = is_device_info(bytes) ? on_device_info(bytes) : on_points(received, bytes);
  if (refusal == Refusal::kNone) return;
  counters_.add(counter_of(refusal));
  health_.packet_refused(refusal);
}

Refusal RslidarNode::on_device_info(std::span<const std::uint8_t> bytes) {
  DifopResult result = parse_difop(bytes);
  if (result.refusal != Refusal::kNone) return result.refusal;
  counters_.add("difop");
  health_.info_packet_used();
  if (config_.distance_resolution == "0.005") result.info.distance_step = 0.005;
  if (config_.distance_resolution == "0.01") result.info.distance_step = 0.01;
  if (result.info != decoder_.device()) decoder_.set_device(result.info);
  return Refusal::kNone;
}

Refusal RslidarNode::on_points(std::int64_t received, std::span<const std::uint8_t> bytes) {
  if (const Refusal refusal = decoder_.decode(bytes, packet_); refusal != Refusal::kNone) return refusal;
  if (!packet_.stamp) counters_.add("clock.invalid");
  const PacketClock::Time time = clock_.time_of(packet_.stamp, received, microseconds(packet_.duration));
  if (const Refusal refusal = follow_head(time); refusal != Refusal::kNone) return refusal;
  publish_points(received, time.utime);
  return Refusal::kNone;
}

Refusal RslidarNode::follow_head(const PacketClock::Time& time) {
  const double blind = (360.0 - decoder_.device().fov) * 100.0;
  const HeadTracker::Step step = head_.follow({time.even, packet_.azimuth, packet_.rate, packet_.duration}, blind);
  if (step.duplicate) return Refusal::kDuplicate;
  if (step.late) return Refusal::kLate;
  if (step.lost > 0) counters_.add("lost.packets", step.lost);
  message_.revolution = step.revolution;
  return Refusal::kNone;
}

void RslidarNode::publish_points(std::int64_t received, std::int64_t utime) {
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

void RslidarNode::publish_raw(std::int64_t received, int port, std::span<const std::uint8_t> bytes) {
  if (bytes.size() > 2 * kRs16PacketSize) return;
  raw_packet_t raw;
  raw.utime = received;
  raw.port = port;
  raw.size = static_cast<std::int32_t>(bytes.size());
  raw.data.assign(bytes.begin(), bytes.end());
  bus_.publish("LIDAR_RAW", raw);
}

NodeReport RslidarNode::report() const {
  NodeReport report;
  report.counters = counters_;
  report.counters.set("revolutions", message_.packet < 0 ? 0 : message_.revolution + 1);
  report.counters.set("clock.device", clock_.uses_device() ? 1 : 0);
  report.counters.set("clock.switches", clock_.switches());
  report.counters.set("clock.jumps", clock_.jumps());
  report.faults = health_.faults();
  if (config_.clock == "device" && std::abs(clock_.last_difference()) > microseconds(config_.clock_tolerance))
    report.faults.push_back("the device's clock is not set: use clock: auto or host, or connect its GPS");
  report.latency_p50 = latency_.percentile(0.5);
  report.latency_p99 = latency_.percentile(0.99);
  return report;
}

}  // namespace curbstone
