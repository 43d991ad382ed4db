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

/// Hands on the packets of LIDAR_POINTS in the order of their numbers. One that is missing was lost on the bus, for the
/// driver counts what it sends. It is asked for, and those behind it wait until it has come or kPatience has passed
/// without any that was missing, as ResendClient counts it: in less than what kMostHeld packets last, in a replay too.
/// So what is handed on is the same whether or not packets were lost, unless they are lost for good. Packets that begin
/// anew or jump in time are handed on as they come. Pure; one thread.
///
/// Two drivers on one channel would mix the scans of two LiDARs in one place. Their numbers give them away: they
/// go back while the time goes on, and no driver is started anew within kRestart. One of the two is handed on.
///
/// Counters: refused.second_lidar, lidar.resent (missing packets that came again), lidar.not_resent (gaps that were
/// given up).
class PacketIntake {
 public:
  using Handler = std::function<void(const lidar_points_t&)>;
  static constexpr std::int64_t kPatience = 1'000'000;  ///< us
  static constexpr std::int64_t kRestart = 50'000;      ///< us, from a driver's last packet to its successor's first
  static constexpr std::size_t kMostHeld = 3000;        ///< packets, 18 MB; newer ones will be asked for in their turn

  PacketIntake(Publisher& bus, const std::string& requester, const std::string& channel)
      : client_(bus, requester, channel) {}

  /// Before the first packet: those since `utime`, us, are wanted too, for another listener had all until then.
  void begin_at(std::int64_t utime) { begin_after_ = utime - 1; }

  /// A packet as it was sent first.
  void hear(const lidar_points_t& packet, const Handler& hand_on);
  /// A packet that was sent again, for whomever.
  void hear_again(const lidar_points_t& packet, const Handler& hand_on);
  /// What waits will wait no longer: the drive is over.
  void release(const Handler& hand_on);
  /// Each 20 ms: asks for what is missing, or gives it up. `now`, us, only paces; in a replay it is message time.
  void tick(std::int64_t now, const Handler& hand_on);

  /// us, stamp of the newest packet heard.
  [[nodiscard]] std::int64_t newest() const { return newest_; }
  [[nodiscard]] std::optional<MissingMessages> missing() const;
  /// That nothing was heard yet, or that more than one LiDAR sent within the last second of message time.
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Last {
    std::int32_t number;
    std::int64_t utime;  // us
  };
  [[nodiscard]] bool is_of_another(const lidar_points_t& packet) const;
  void refuse_held_of_another(const lidar_points_t& packet);
  [[nodiscard]] bool is_gap_before(const lidar_points_t& packet) const;
  [[nodiscard]] std::deque<lidar_points_t>::iterator place_of(std::int32_t number);
  [[nodiscard]] bool holds(std::int32_t number);
  void hold(const lidar_points_t& packet);
  void pass(const lidar_points_t& packet, const Handler& hand_on);
  void pass_held(const Handler& hand_on);
  void give_up(const Handler& hand_on);

  ResendClient client_;
  std::optional<std::int64_t> begin_after_;  // us
  std::optional<Last> last_;                 // handed on
  std::deque<lidar_points_t> held_;          // by number
  std::int64_t newest_ = 0;
  std::int64_t another_ = 0;  // us, newest of a second LiDAR
  std::int64_t ticked_ = 0;   // us
  std::int64_t waited_ = 0;   // us, since something missing came last, or the gap was found
  Counters counters_;
};

}  // namespace curbstone::mapper::scan
