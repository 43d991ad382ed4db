#pragma once

#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/resend/resend_client.hpp"

namespace curbstone::mapper::scan {

/// Passes on the packets of LIDAR_POINTS in the order of their sequence numbers. A missing number means a loss on the
/// bus, because the driver numbers what it sends. The missing packet is requested. Later packets wait until it arrives,
/// or until kPatience has passed without any of the missing ones (counted by ResendClient), which is less than the time
/// that kMaxHeld packets last, in a replay too. So the output is the same with and without loss, unless packets are
/// lost for good. Packets whose numbers restart, or whose time jumps, are passed on as they come. Pure; one thread.
///
/// Two drivers on one channel would mix the scans of two LiDARs. Their sequence numbers reveal it: the numbers go back
/// while time advances, and no driver restarts within kRestart. Only one of the two is passed on. It is a fault if they
/// alternate: a driver that was killed and restarted at once only loses what it sends within kRestart. Packets more
/// than kLongAgo in the past that do not continue from the last one belong to a log that is played into the bus, unless
/// kClockWasSet of them come in a row.
///
/// Counters: refused.second_lidar, lidar.resent (missing packets that came again), lidar.not_resent (gaps that were
/// given up).
class PacketIntake {
 public:
  using Handler = std::function<void(const lidar_points_t&)>;
  static constexpr std::int64_t kPatience = 1'000'000;  ///< us
  static constexpr std::int64_t kRestart = 50'000;      ///< us, from a driver's last packet to its successor's first
  static constexpr std::int64_t kLongAgo = 5'000'000;   ///< us
  static constexpr int kClockWasSet = 400;              ///< packets, half a second and more than any burst
  static constexpr std::size_t kMaxHeld = 3000;         ///< packets, 18 MB; newer ones are requested later

  PacketIntake(Publisher& bus, const std::string& requester, const std::string& channel)
      : client_(bus, requester, channel) {}

  /// To be called before the first packet: packets since `utime`, us, are requested too. Another listener had all
  /// packets until then.
  void begin_at(std::int64_t utime) { begin_after_ = utime - 1; }

  /// Takes a packet that was sent for the first time.
  void add(const lidar_points_t& packet, const Handler& handler);
  /// Takes a packet that was sent again, no matter who requested it.
  void add_resent(const lidar_points_t& packet, const Handler& handler);
  /// Passes on everything that waits: the drive is over.
  void release(const Handler& handler);
  /// Called every 20 ms: requests what is missing, or gives it up. `now`, us, only sets the pace; in a replay it is
  /// message time.
  void tick(std::int64_t now, const Handler& handler);

  /// us, stamp of the newest packet heard.
  [[nodiscard]] std::int64_t newest() const { return newest_; }
  [[nodiscard]] std::optional<MissingMessages> missing() const;
  /// Adds a fault: more than one LiDAR sent within the last second of message time.
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Last {
    std::int32_t number;
    std::int64_t utime;  // us
  };
  [[nodiscard]] bool is_from_second_lidar(const lidar_points_t& packet) const;
  [[nodiscard]] bool is_of_long_ago(const lidar_points_t& packet) const;
  void drop_held_of_second_lidar(const lidar_points_t& packet);
  [[nodiscard]] bool is_gap_before(const lidar_points_t& packet) const;
  [[nodiscard]] std::deque<lidar_points_t>::iterator place_of(std::int32_t number);
  [[nodiscard]] bool holds(std::int32_t number);
  void hold(const lidar_points_t& packet);
  void pass(const lidar_points_t& packet, const Handler& handler);
  void pass_held(const Handler& handler);
  void give_up(const Handler& handler);

  ResendClient client_;
  std::optional<std::int64_t> begin_after_;  // us
  std::optional<Last> last_;                 // passed on
  std::deque<lidar_points_t> held_;          // in order of sequence numbers
  std::int64_t newest_ = 0;
  std::int64_t refused_ = 0;  // us, newest refused packet: of a second LiDAR, or of a driver that has just restarted
  std::int64_t second_lidar_ = 0;  // us, newest of a second LiDAR
  int long_ago_ = 0;               // packets of long ago, in a row
  std::int64_t ticked_ = 0;        // us
  std::int64_t waited_ = 0;        // us, since a missing packet last came, or since the gap was found
  Counters counters_;
};

}  // namespace curbstone::mapper::scan
