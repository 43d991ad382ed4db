#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"

namespace curbstone::mapper::tracking {

/// Compares the way by odometry with the way by two scans alone (ScanToScanMotion), in distance and direction.
/// Registration to the map does not show a difference: it begins at the pose that odometry predicts, and stays there on
/// a street that looks the same for metres, or once the vehicle is beyond its reach of a few decimetres.
///
/// kMinPairs pairs in a row that differ are a fault, until as many agree. If they agree on a direction that is not
/// odometry's, the LiDAR's yaw is wrong. Otherwise the LiDAR is believed, and odometry denied, if by the LiDAR the
/// vehicle moves as it did when both last agreed: then the LiDAR does not follow a lorry beside the vehicle. Pairs that
/// agree with odometry's way as well as with their own are ignored. A value; pure. Counters: faults.odometry.way,
/// faults.lidar.aside (times that it began).
class OdometryCheck {
 public:
  static constexpr std::size_t kMinPairs = 3;  ///< pairs in a row

  /// Two scans a short time apart.
  struct Pair {
    std::int64_t utime = 0;                                 ///< us, the end of the second
    double seconds = 0;                                     ///< between their ends
    Eigen::Vector2d by_odometry = Eigen::Vector2d::Zero();  ///< m, x and y of base_link
    Eigen::Vector2d by_scans = Eigen::Vector2d::Zero();
    double sigma = 0;                    ///< m, 1 sigma of by_scans
    double agreement = 0;                ///< 0..1, share of points that fit with by_scans
    double agreement_with_odometry = 0;  ///< the same with by_odometry
  };
  void add(const Pair& pair);

  /// Odometry's way differs from the LiDAR's, and not by a constant direction.
  [[nodiscard]] bool disagrees() const { return state_ == State::kDistance; }
  /// apart(), and the LiDAR is believed.
  [[nodiscard]] bool rejects_odometry() const { return disagrees() && is_continuous_; }
  /// rad by which the LiDAR's way points to the left of odometry's; nothing if the direction is not the fault.
  [[nodiscard]] std::optional<double> heading_offset() const;
  /// The last pair differed, and there is no fault yet: the next pair should come soon.
  [[nodiscard]] bool is_suspect() const { return !differing_.empty() && state_ == State::kGood; }
  /// No pair of a moving vehicle has agreed with odometry yet.
  [[nodiscard]] bool is_new() const { return is_new_; }
  [[nodiscard]] bool agrees() const { return differing_.empty() && state_ == State::kGood; }
  /// Appends the fault in words. `yaw`: rad, of vehicle.lidar.
  void add_faults(std::vector<std::string>& faults, double yaw) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  enum class State { kGood, kDistance, kDirection };
  void decide();

  State state_ = State::kGood;
  std::deque<Pair> differing_;                                 // pairs in a row that differ, up to kMinPairs
  std::size_t num_agreeing_ = 0;                               // pairs in a row that agree
  Pair last_;                                                  // the last pair that differed
  Eigen::Vector2d agreed_velocity_ = Eigen::Vector2d::Zero();  // m/s by the scans, when both last agreed
  bool is_continuous_ = false;
  bool is_new_ = true;
  double heading_offset_ = 0;
  Counters counters_;
};

}  // namespace curbstone::mapper::tracking
