#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/returns/level_distances.hpp"

namespace curbstone::mapper::returns {

/// Finds lasers that look aside of the driver's table, or whose ranges are too long or too short: a wrong file of
/// angles, another device's file, a laser out of adjustment. Such a laser draws each wall and each curb twice.
///
/// Where the lasers above and below one meet the same upright surface, it meets that surface too. What it measured
/// there, turned by some angle and shortened by some length, fits what they measured; that angle and that length are
/// its errors. Ground, which no two lasers meet equally far away, does not take part, nor do the lowest and the highest
/// laser. The check needs neither the pose nor the mounting of the LiDAR. A laser is wrong once kLooks looks in a row
/// say the same, until as many say that it is right. Its points are left out. If more than a quarter of all lasers are
/// wrong, it is not certain which are right: all are used, and the fault says so.
///
/// A function of the scans alone. Pure; one thread. Counters: faults.laser_aligned (lasers that were found wrong),
/// withheld.laser_aligned (their points).
class LaserAlignment {
 public:
  static constexpr int kLooks = 10;      ///< in a row, a metre of way apart
  static constexpr double kAside = 0.9;  ///< deg: wrong from here on
  static constexpr double kOff = 0.10;   ///< m: likewise

  /// To be called for each metre of way.
  void check(const std::vector<LaserDistances>& lasers);
  /// Removes the points of the wrong lasers, if they are few.
  void withhold(scan::Scan& scan);
  [[nodiscard]] bool any_wrong() const { return num_wrong_ > 0; }
  [[nodiscard]] bool is_wrong(std::size_t ring) const { return ring < kMaxLasers && lasers_[ring].wrong; }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

  /// What a look says of a laser.
  struct Error {
    double aside = 0;  ///< deg, that it looks to the left of its angle
    double off = 0;    ///< m, that its ranges are too long
  };

 private:
  struct Laser {
    Error error;    // of the last look that showed one
    int looks = 0;  // in a row that show it,
    int right = 0;  // or none
    bool wrong = false;
  };
  void judge(std::size_t ring, const Error& error);
  [[nodiscard]] bool are_few() const { return 4 * num_wrong_ <= num_lasers_; }

  std::array<Laser, kMaxLasers> lasers_{};
  int num_wrong_ = 0;
  int num_lasers_ = 0;
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
