#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::returns {

/// Whether the LiDAR sees the ground beyond kNear: without it no curb is found there, and nothing else shows it, for
/// houses and cars hold the map together. A LiDAR that is tilted up, dirt on the lower half of its window, a wet or
/// snowed road.
///
/// A sector of 10 deg is open where returns come from it and nothing tall stands within `open_until` m. Of the open
/// ones almost all show the ground from kNear on, in a street, an alley, on a slope. Where next to none has in
/// kLooks looks, it is a fault, until some do. Two things are looked at: all about the vehicle, standing too; and,
/// while it moves, what is ahead, where ground must be, for a LiDAR that is tilted up still sees it behind. Where cars
/// and houses stand about it closely nothing is said. Nor of a LiDAR below kLowest, between whose beams the ground is
/// farther apart than that.
///
/// A LiDAR that hangs upside down, unlike what its vehicle's file says, shows the ground as high above itself as it
/// should lie below: kManyAbove of its returns, and next to none where the ground is. A ceiling has a floor below it.
///
/// Status only. A function of the calls. Pure; one thread. Counters: faults.no_ground, faults.lidar.upside_down (times
/// that it began).
class GroundInSight {
 public:
  static constexpr int kSectors = 36;
  static constexpr int kEvery = 4;           ///< revolutions: one of them is looked at
  static constexpr int kLooks = 25;          ///< before anything is said; the memory of what was seen
  static constexpr double kFew = 0.15;       ///< of the open sectors: fewer are a fault,
  static constexpr double kEnough = 0.3;     ///< until it is that many
  static constexpr float kNear = 6.0F;       ///< m
  static constexpr double kLowest = 0.6;     ///< m above the ground
  static constexpr double kManyAbove = 0.1;  ///< of the returns
  static constexpr double kFewBelow = 0.2;   ///< of those above

  explicit GroundInSight(const Pose& T_base_lidar);

  /// Each revolution, in lidar. `moved`: the vehicle has, since that was last so, by 0.2 m or so.
  void look(const scan::Scan& scan, bool moved);
  /// Of the open sectors, those that showed the ground of late. 1 before anything was seen.
  [[nodiscard]] double share() const { return about_.share(); }
  [[nodiscard]] double share_ahead() const { return ahead_.share(); }
  [[nodiscard]] bool is_upside_down() const { return is_upside_down_; }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Sight {
    int looks = 0;
    double open = 0.0;    // sectors, of late
    double seeing = 0.0;  // of them
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
  int looks_upside_down_ = 0;  // more than the other way round, of late
  bool is_upside_down_ = false;
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
