#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/returns/level_distances.hpp"

namespace curbstone::mapper::returns {

/// Finds lasers that are taken for others: a table of another device, or with two lines swapped.
///
/// Only lasers that look below the horizon are judged. Of two of them the lower one meets the ground, or what stands on
/// it, no farther away than the upper one; only beneath what hangs it sees farther. If it does in most directions, the
/// two are not in the order of their table. The lasers that contradict most others are wrong, once kLooks looks in a
/// row say so, until as many say that they are right. Their points are left out. If they are more than a quarter of
/// those, it is not certain which are right: all are used, and the fault says so. If no two lasers are in order, the
/// LiDAR is upside down, which GroundInSight finds.
///
/// A function of the calls. Pure; one thread. Counters: faults.laser_order (lasers that were found wrong),
/// withheld.laser_order (their points).
class LaserOrder {
 public:
  static constexpr int kLooks = 10;  ///< in a row

  explicit LaserOrder(const Pose& T_base_lidar) : up_(T_base_lidar.linear()(2, 2) < 0 ? -1.0F : 1.0F) {}

  /// To be called for each metre of way.
  void check(const std::vector<LaserDistances>& lasers);
  /// Removes the points of the wrong lasers, if they are few.
  void withhold(scan::Scan& scan);
  [[nodiscard]] bool any_wrong() const { return !wrong().empty(); }
  /// Their rings.
  [[nodiscard]] std::vector<int> wrong() const;
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Laser {
    int looks = 0;  // in a row that contradict `wrong`
    bool wrong = false;
  };
  [[nodiscard]] bool are_few() const { return 4 * wrong().size() <= num_judged_; }

  float up_;
  std::array<Laser, kMaxLasers> lasers_{};
  std::size_t num_judged_ = 0;
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
