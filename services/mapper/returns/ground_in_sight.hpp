#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::returns {

/// Checks that the LiDAR sees the ground beyond kNear. Without it no curb is found, and nothing else shows the fault,
/// for houses and cars suffice for registration. Causes: a LiDAR that is tilted up, dirt on the lower half of its
/// window, a wet or snow-covered road.
///
/// A sector of 10 deg is open if it has returns and nothing tall stands within `open_until` m. Almost all open sectors
/// show the ground from kNear on, in a street, in an alley, on a slope. If hardly any did in kLooks looks, it is a
/// fault, until some do again. There are two checks: all around the vehicle, also at standstill; and ahead of it while
/// it moves, where ground must be, for a LiDAR that is tilted up still sees the ground behind. If cars and houses stand
/// close all around, there is no verdict; nor for a LiDAR below kLowest, whose rings on the ground are too far apart.
///
/// A LiDAR that hangs upside down, contrary to its vehicle's file, shows the ground as high above itself as it should
/// be below: kManyAbove of its returns, and few where the ground should be. Only where both can be told apart, within
/// some 12 m. A ceiling differs in that there is a floor below it.
///
/// Changes nothing itself: MapperNode turns the map's LiDAR over at the start of a drive. A function of the calls.
/// Pure; one thread. Counters: faults.no_ground, faults.lidar.upside_down (times that the fault began).
class GroundInSight {
 public:
  static constexpr int kSectors = 36;
  static constexpr int kEvery = 4;           ///< revolutions per look
  static constexpr int kLooks = 25;          ///< before there is a verdict; also the length of the memory
  static constexpr double kFew = 0.15;       ///< of the open sectors: a fault is raised below it,
  static constexpr double kEnough = 0.3;     ///< and cleared from here on
  static constexpr float kNear = 6.0F;       ///< m
  static constexpr double kLowest = 0.6;     ///< m above the ground
  static constexpr double kManyAbove = 0.1;  ///< of the returns
  static constexpr double kFewBelow = 0.4;   ///< of those above: reflections, and what hangs

  explicit GroundInSight(const Pose& T_base_lidar);

  /// To be called for each revolution, in lidar. `moved`: the vehicle has moved by 0.2 m or so since `moved` was last
  /// true.
  void check(const scan::Scan& scan, bool moved);
  /// Share of the open sectors that recently showed the ground. 1 before the first look.
  [[nodiscard]] double share() const { return about_.share(); }
  [[nodiscard]] double share_ahead() const { return ahead_.share(); }
  [[nodiscard]] bool is_upside_down() const { return is_upside_down_; }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Sight {
    int looks = 0;
    double open = 0.0;    // sectors, recent mean
    double seeing = 0.0;  // of these
    bool missing = false;
    [[nodiscard]] double share() const { return open > 0 ? seeing / open : 1.0; }
    [[nodiscard]] bool loses(int now_open, int now_seeing);
  };

  [[nodiscard]] std::ptrdiff_t count_ground(const scan::Scan& scan, bool upside_down) const;
  void judge_upside_down(const scan::Scan& scan);

  Eigen::Isometry3f T_base_lidar_;
  float open_until_;  // m
  float far_;         // m
  int revolution_ = 0;
  Sight about_, ahead_;
  int looks_upside_down_ = 0;  // looks that show it, less those that contradict it, recently
  bool is_upside_down_ = false;
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
