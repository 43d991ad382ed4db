#pragma once

#include <curbstone/lidar_points_t.hpp>
#include <curbstone/raw_packet_t.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/node.hpp"
#include "common/bus/refusal_share.hpp"
#include "common/resend/recent_messages.hpp"
#include "common/shell/latency.hpp"
#include "drivers/lidar/decoding/head_tracker.hpp"
#include "drivers/lidar/decoding/packet_clock.hpp"
#include "drivers/lidar/decoding/packet_order.hpp"
#include "drivers/lidar/host_clock.hpp"
#include "drivers/lidar/lidar_config.hpp"
#include "drivers/lidar/lidar_health.hpp"
#include "drivers/lidar/lost_packets.hpp"
#include "drivers/lidar/models/model_vote.hpp"
#include "drivers/lidar/packet_role.hpp"
#include "drivers/lidar/sent_packet.hpp"
#include "drivers/lidar/silent_lasers.hpp"

namespace curbstone::lidar {

/// Converts a LiDAR's packets to LIDAR_POINTS (and LIDAR_RAW on request): one message per packet. The output is a
/// function of the packets, their times of receipt and of whether the host's clock is synchronised. One thread. A
/// packet that cannot be used is counted by cause. The newest messages are kept, and resent to a subscriber that lost
/// them.
class LidarNode final : public Node {
 public:
  /// Throws std::runtime_error with a one-line message if the configuration does not fit the model.
  LidarNode(const LidarConfig& config, Publisher& bus, HostClockCheck host_clock = kernel_clock_is_synchronised);

  /// Where lines for the process's log go. Without it there are none, as in tools that print their own.
  using Print = std::function<void(const std::string& line)>;
  void print_to(Print print) { print_ = std::move(print); }
  void print(const std::string& line) const {
    if (print_) print_(line);
  }

  void connect(Subscriber& bus) override;

  /// Takes a packet of the device; `received` in us since the Unix epoch. The bytes identify its kind, so all kinds may
  /// come on one port.
  void on_packet(std::int64_t received, int port, std::span<const std::uint8_t> bytes);
  /// Takes a packet from a log.
  void on(const raw_packet_t& packet);

  /// What these bytes are to the model; while it is unknown, to any that it could be.
  [[nodiscard]] sources::OneSender::Kind role_of_packet(std::span<const std::uint8_t> bytes) const {
    return role_of(model_.get(), models::sender_of(bytes));
  }

  /// The next packet is of another device of the model: what the former one has reported of itself is not true of it.
  void forget_device();

  /// Call it before the first packet of a capture with only one device information.
  void expect_one_info();

  /// Number of packets dropped by the kernel since the start.
  void set_dropped(std::int64_t packets) { counters_.set("dropped.socket", packets); }
  /// Fault of the packet source, in words; empty if there is none.
  void set_source_fault(const std::string& fault) { source_fault_ = fault; }
  /// Fault that more than one device sends, in words; empty if there is none.
  void set_sender_fault(const std::string& fault) { sender_fault_ = fault; }
  /// Sizes of a socket's receive buffer, bytes: requested, and granted by the kernel.
  void set_receive_buffer(int asked, int granted);

  /// Sets a counter of the packet source: "refused.source".
  void set_counter(std::string_view name, std::int64_t count) { counters_.set(name, count); }

  void clock_was_set(std::int64_t by) override;
  void tick(std::int64_t now) override;
  void finish() override;
  [[nodiscard]] NodeReport report() const override;

 private:
  /// Device information that came before the model was known.
  struct EarlyInfo {
    std::int64_t received;
    std::vector<std::uint8_t> bytes;
  };
  [[nodiscard]] decoding::Refusal on_points(std::int64_t received, std::span<const std::uint8_t> bytes);
  [[nodiscard]] decoding::Refusal on_info(std::int64_t received, std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool find_model(std::int64_t received, std::span<const std::uint8_t> bytes);
  void keep_early_info(std::int64_t received, std::span<const std::uint8_t> bytes);
  void refuse(const char* counter, const std::string& remedy);
  void send_ready();
  void send(decoding::PendingPacket& packet);
  [[nodiscard]] std::int32_t scan_of_count();
  void publish_raw(std::int64_t received, int port, std::span<const std::uint8_t> bytes);
  /// The device's own report of itself is known and not out of date.
  [[nodiscard]] bool has_recent_info() const { return model_ && !health_.info_is_old(); }
  void add_counters(Counters& counters) const;
  void add_loss_faults(std::vector<std::string>& faults) const;
  void add_clock_faults(std::vector<std::string>& faults) const;

  LidarConfig config_;
  Publisher& bus_;
  RecentMessages<SentPacket> sent_;
  HostClockCheck host_clock_;
  Print print_;
  models::ModelSettings settings_;
  models::ModelVote vote_;
  std::deque<EarlyInfo> early_info_;
  models::ModelName model_name_;          ///< as decided, with `auto`
  std::unique_ptr<models::Model> model_;  ///< none until `model: auto` is decided
  decoding::PacketOrder order_;
  decoding::PacketClock clock_;
  decoding::HeadTracker head_;
  LidarHealth health_;
  RefusalShare share_;
  LostPackets lost_;
  LostPackets not_sent_;  // the part of them that the device did not send, as it was silent
  SilentLasers lasers_;
  Counters counters_;
  LatencyWindow latency_;
  lidar_points_t message_{};

  std::optional<bool> host_is_synchronised_;
  std::int64_t now_ = 0;  ///< us, of the last tick
  std::int64_t second_began_ = 0;
  std::int64_t lost_on_the_way_ = 0;  // packets, when last counted
  std::int64_t lost_in_second_ = 0;
  int in_scan_ = 0;  ///< packets of the current revolution so far, with split_packets
  bool came_since_tick_ = false;
  models::Identity identity_;  ///< as logged
  std::string source_fault_;
  std::string sender_fault_;
  std::string buffer_fault_;
};

}  // namespace curbstone::lidar
