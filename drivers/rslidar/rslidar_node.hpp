#pragma once

#include <curbstone/lidar_points_t.hpp>
#include <curbstone/raw_packet_t.hpp>
#include <span>

#include "common/latency.hpp"
#include "common/node.hpp"
#include "drivers/rslidar/decoder.hpp"
#include "drivers/rslidar/head_tracker.hpp"
#include "drivers/rslidar/lidar_health.hpp"
#include "drivers/rslidar/packet_clock.hpp"
#include "drivers/rslidar/rslidar_config.hpp"

namespace curbstone {

/// RS-LiDAR-16 packets in, LIDAR_POINTS (and LIDAR_RAW on request) out: one message a packet. What it sends is a
/// function of the packets and their times of receipt.
class RslidarNode final : public Node {
 public:
  RslidarNode(const RslidarConfig& config, Publisher& bus);

  void connect(Subscriber& bus) override { (void)bus; }

  /// A packet from the device; `received` in us since the Unix epoch. Point packets and device information are told
  /// apart by their magic, so that both may come on one port.
  void on_packet(std::int64_t received, int port, std::span<const std::uint8_t> bytes);
  /// The same from a log.
  void on(const raw_packet_t& packet);

  /// Packets that the kernel threw away, so far.
  void set_dropped(std::int64_t packets) { counters_.set("dropped.socket", packets); }

  void tick(std::int64_t now) override { health_.tick(now); }
  [[nodiscard]] NodeReport report() const override;

 private:
  Refusal on_points(std::int64_t received, std::span<const std::uint8_t> bytes);
  Refusal on_device_info(std::span<const std::uint8_t> bytes);
  Refusal follow_head(const PacketClock::Time& time);
  void publish_points(std::int64_t received, std::int64_t utime);
  void publish_raw(std::int64_t received, int port, std::span<const std::uint8_t> bytes);

  RslidarConfig config_;
  Publisher& bus_;
  Rs16Decoder decoder_;
  PacketClock clock_;
  HeadTracker head_;
  LidarHealth health_;
  Counters counters_;
  LatencyWindow latency_;
  DecodedPacket packet_;
  lidar_points_t message_{};
};

}  // namespace curbstone
