#pragma once

#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"

namespace curbstone::mapper::scan {

/// Keeps the stamps of LIDAR_POINTS on odometry's clock if the LiDAR's clock alone is set: its source of time (GPS,
/// PTP) comes or goes, or the clock of its driver's host is set. The stamps then step from one packet to the next. They
/// also step after a pause of the driver, and if all clocks are set. Therefore the packets after a step are held until
/// odometry decides which it was:
///
/// - Its stamps agree with the new ones: the packets pass unchanged.
/// - Its stamps continue in the old clock, kProof beyond the step: the LiDAR's clock alone was set, and the step is
///   subtracted from this and all later stamps.
/// - Neither within kMaxHold: the packets pass unchanged.
///
/// If the next packet continues in the old clock, only the held stamps were wrong, and they are corrected. If it also
/// continues in the clock of the held packets, all sensors paused, and they pass unchanged. A packet with a smaller
/// step is held until the next packet, for this check alone. Without odometry nothing is held. Pure; one thread. Time
/// is LiDAR time; which of the two channels is heard first matters from kAgree on.
///
/// Counters: lidar.clock_corrections (steps taken out), lidar.stamps_corrected (packets of which only the stamp was
/// wrong), refused.lidar_stamp (packets after a step that fit neither clock).
class LidarClock {
 public:
  using Handler = std::function<void(const lidar_points_t&)>;
  static constexpr std::int64_t kStepBack = 100'000;     ///< us: smaller steps of the clock are left as they are
  static constexpr std::int64_t kStepAhead = 250'000;    ///< us: more than a driver pauses that sends part of the view
  static constexpr std::int64_t kAgree = 50'000;         ///< us, between the stamps of LiDAR and odometry
  static constexpr std::int64_t kProof = 200'000;        ///< us
  static constexpr std::int64_t kHoldBack = 300'000;     ///< us, at least, before a step back is taken out
  static constexpr std::int64_t kHoldAhead = 1'000'000;  ///< us: after a pause of all senders odometry may be late
  static constexpr std::int64_t kMaxHold = 2'000'000;    ///< us
  static constexpr std::size_t kMaxHeld = 12'000;        ///< packets

  /// Takes a packet, in the order of sequence numbers except for late ones, and passes `handler` all that are due.
  /// `odometry`: us, the newest stamp; 0: there is none.
  void add(const lidar_points_t& packet, std::int64_t odometry, const Handler& handler);
  /// Passes on what is held, as it is: the drive is over.
  void release(const Handler& handler);

  /// us: the stamp of the newest packet, corrected; while packets are held, as if their clock had not been set.
  [[nodiscard]] std::int64_t corrected(std::int64_t utime) const;
  /// Adds faults: stamps are corrected; they are far from odometry's.
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Heard {
    std::int32_t number;
    std::int64_t utime;     // us, corrected
    std::int64_t odometry;  // us, newest at that time; 0: none
  };
  struct Step {
    std::int64_t by;
    std::int64_t tolerance;  // us, between a stamp and the one that is expected
    std::int64_t began;      // us, the first stamp after it
    Heard newest;            // in the new clock
    int misfits = 0;         // packets in a row that fit neither clock
  };
  enum class Verdict { kOpen, kAsTheyAre, kLidarAlone };

  [[nodiscard]] bool is_late(const lidar_points_t& packet) const;
  [[nodiscard]] std::int64_t expected_after(const Heard& before, const Heard& now) const;
  void follow(const Heard& now);
  void compare_with_odometry(const Heard& now);
  [[nodiscard]] bool is_followed_by_odometry(const Heard& now);
  void set_right();
  void hold(const lidar_points_t& packet, const Heard& now, const Handler& handler);
  void end_pause(const lidar_points_t& packet, const Heard& now, const Handler& handler);
  [[nodiscard]] Verdict verdict() const;
  void end_step(std::int64_t correction, const Handler& handler);

  std::optional<Heard> last_;  // passed on
  std::optional<Step> step_;
  std::deque<lidar_points_t> held_;  // since the step
  std::int64_t correction_ = 0;      // us, added to all stamps
  std::int64_t interval_ = 0;        // us, between packets
  int followed_ = 0;                 // packets in a row whose stamps agree with odometry as they come
  std::optional<double> ahead_;      // us, smoothed: the LiDAR's newest stamp less odometry's
  int differing_ = 0;                // times in a row that it was another
  int agreeing_ = 0;                 // times in a row that it was the same
  Counters counters_;
};

}  // namespace curbstone::mapper::scan
