#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"

namespace curbstone::mapper::tracking {

/// Whether odometry goes as far as two scans alone (PairMotion) say, and in the same direction. Registration to the map
/// does not tell: it begins where odometry leads, and on a street that looks the same for metres, or once the vehicle
/// has left the reach of a few decimetres, it stays there.
///
/// Once kLeast pairs in a row say that the vehicle goes elsewhere it is a fault, until as many say that it does not.
/// Where they agree on a direction that is not odometry's, it is the LiDAR that is mounted otherwise. Else the LiDAR is
/// believed if the vehicle goes on by it as it did when both agreed: then it is no lorry beside it that the LiDAR
/// follows. Pairs that show odometry's way as well as their own say nothing. A value; pure. Counters:
/// faults.odometry.way, faults.lidar.aside (times that it began).
class WayCheck {
 public:
  static constexpr std::size_t kLeast = 3;  ///< pairs in a row

  /// Two scans shortly after each other.
  struct Pair {
    std::int64_t utime = 0;                                 ///< us, the end of the second
    double seconds = 0;                                     ///< between their ends
    Eigen::Vector2d by_odometry = Eigen::Vector2d::Zero();  ///< m, x and y of base_link
    Eigen::Vector2d by_scans = Eigen::Vector2d::Zero();
    double sigma = 0;                    ///< m, 1 sigma of by_scans
    double agreement = 0;                ///< 0..1, of the scans with by_scans,
    double agreement_with_odometry = 0;  ///< and with by_odometry
  };
  void add(const Pair& pair);

  /// Odometry goes elsewhere than the LiDAR,
  [[nodiscard]] bool apart() const { return state_ == State::kDistance; }
  /// and it is the LiDAR that is believed.
  [[nodiscard]] bool denied() const { return apart() && goes_on_; }
  /// rad that the LiDAR's way is to the left of odometry's, where that is what is wrong.
  [[nodiscard]] std::optional<double> aside() const;
  /// The last pair said so: the next should come soon.
  [[nodiscard]] bool in_doubt() const { return !others_.empty() && state_ == State::kGood; }
  /// No pair has agreed yet on a way that a vehicle goes which does not stand.
  [[nodiscard]] bool is_new() const { return is_new_; }
  [[nodiscard]] bool good() const { return others_.empty() && state_ == State::kGood; }
  /// `yaw`: rad, of vehicle.lidar.
  void add_faults(std::vector<std::string>& faults, double yaw) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  enum class State { kGood, kDistance, kDirection };
  void decide();

  State state_ = State::kGood;
  std::deque<Pair> others_;                        // in a row, up to kLeast
  std::size_t same_ = 0;                           // in a row
  Pair last_;                                      // that differed
  Eigen::Vector2d was_ = Eigen::Vector2d::Zero();  // m/s by the scans, when both last agreed
  bool goes_on_ = false;
  bool is_new_ = true;
  double aside_ = 0;
  Counters counters_;
};

}  // namespace curbstone::mapper::tracking
