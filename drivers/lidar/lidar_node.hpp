#pragma once

#include <curbstone/lidar_points_t.hpp>
#include <curbstone/raw_packet_t.hpp>
#include <span>
#include <string_view>

#include "common/bus/node.hpp"
#include "common/shell/latency.hpp"
#include "drivers/lidar/decoding/decoder.hpp"
#include "drivers/lidar/decoding/head_tracker.hpp"
#include "drivers/lidar/decoding/packet_clock.hpp"
#include "drivers/lidar/lidar_config.hpp"
#include "drivers/lidar/packet/lidar_health.hpp"

namespace curbstone::lidar {

/// RS-LiDAR-16 packets in, LIDAR_POINTS (and LIDAR_RAW on request) out: one message a packet. What it sends is a
/// function of the packets and their times of receipt. One thread. A packet that cannot be used is counted by cause.
class LidarNode final : public Node {
 public:
  LidarNode(const LidarConfig& config, Publisher& bus);

  void connect(Subscriber& bus) override { (void)bus; }

  /// A packet from the device; `received` in us since the Unix epoch. The first bytes tell point packets and device
  /// information apart, so both may come on one port.
  void on_packet(std::int64_t received, int port, std::span<const std::uint8_t> bytes);
  /// The same from a log.
  void on(const raw_packet_t& packet);

  /// Packets that the kernel has dropped since the start.
  void set_dropped(std::int64_t packets) { counters_.set("dropped.socket", packets); }

  /// A count that is kept where the packets come from: "refused.source".
  void set_counter(std::string_view name, std::int64_t count) { counters_.set(name, count); }

  void tick(std::int64_t now) override { health_.tick(now); }
  [[nodiscard]] NodeReport report() const override;

 private:
  packet::Refusal on_points(std::int64_t received, std::span<const std::uint8_t> bytes);
  packet::Refusal on_device_info(std::span<const std::uint8_t> bytes);
  packet::Refusal follow_head(const decoding::PacketClock::Time& time);
  void publish_points(std::int64_t received, std::int64_t utime);
  void publish_raw(std::int64_t received, int port, std::span<const std::uint8_t> bytes);

  LidarConfig config_;
  Publisher& bus_;
  decoding::Rs16Decoder decoder_;
  decoding::PacketClock clock_;
  decoding::HeadTracker head_;
  packet::LidarHealth health_;
  Counters counters_;
  LatencyWindow latency_;
  decoding::DecodedPacket packet_;
  lidar_points_t message_{};
};

}  // namespace curbstone::lidar
