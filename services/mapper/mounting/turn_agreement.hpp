#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/pose_pairs.hpp"

namespace curbstone::mapper::mounting {

/// Compares the turn by registration with that by odometry over the last second. Over so short a time the error of a
/// gyro, or of a registration that slides, is tenths of a degree. A larger difference means that registration follows
/// something large that drives alongside, that the LiDAR's mount slips, or that the gyro is wrong: from there on the
/// map is bent, though every revolution fits it.
///
/// Pure; one thread. Counters: faults.apart.turn, .tilt (times that the fault began).
class TurnAgreement {
 public:
  static constexpr std::int64_t kReportedFor = 60'000'000;  ///< us after the last disagreement
  static constexpr double kTilt = 0.026;                    ///< rad

  /// Adds the next revolution, which fitted the map.
  void add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base);
  /// Breaks the sequence: the next revolution is not compared with earlier ones.
  void interrupt() { pairs_.clear(); }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Disagreement {
    double max = 0;          // rad, since the disagreement began
    std::int64_t since = 0;  // us, of the last disagreement; 0: never
  };
  void note(Disagreement& apart, double by, double limit, const char* counter);
  [[nodiscard]] bool is_reported(const Disagreement& apart) const {
    return apart.since != 0 && utime_ - apart.since < kReportedFor;
  }

  scan::PosePairs pairs_;
  std::int64_t utime_ = 0;
  Disagreement turn_, tilt_;
  Counters counters_;
};

}  // namespace curbstone::mapper::mounting
