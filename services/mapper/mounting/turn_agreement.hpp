#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/pose_pairs.hpp"

namespace curbstone::mapper::mounting {

/// Compares how the vehicle turned by the LiDAR with how it did by odometry, over the last second. A gyro is off by
/// tenths of a degree in so short a time, and so is a registration that slides. What is beyond is a LiDAR that follows
/// something large that drives along beside it, whose mount slips, or a gyro that is wrong: from there on the map is
/// bent, though every revolution fits it.
///
/// Pure; one thread. Counters: faults.apart.turn, .tilt (times that it began).
class TurnAgreement {
 public:
  static constexpr std::int64_t kReportedFor = 60'000'000;  ///< us after it was last so
  static constexpr double kTilt = 0.026;                    ///< rad

  /// The next revolution, which fitted the map.
  void add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base);
  /// What comes now has nothing to do with what came before.
  void interrupt() { pairs_.clear(); }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Apart {
    double most = 0;         // rad, since it began
    std::int64_t since = 0;  // us, when it was so last; 0: never
  };
  void note(Apart& apart, double by, double limit, const char* counter);
  [[nodiscard]] bool is_reported(const Apart& apart) const {
    return apart.since != 0 && utime_ - apart.since < kReportedFor;
  }

  scan::PosePairs pairs_;
  std::int64_t utime_ = 0;
  Apart turn_, tilt_;
  Counters counters_;
};

}  // namespace curbstone::mapper::mounting
