#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/mounting/azimuth_profile.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::mounting {

/// Detects that the LiDAR turns in its mount: a loose screw, a knock. Ground and near surfaces fit a map at any yaw, so
/// registration may not notice, and the map is smeared.
///
/// Each scan is compared with the one before the last, by their azimuth profiles and odometry's motion between them. A
/// LiDAR that turns in its mount does so within a scan or two, and is then still: its yaw is corrected. Something large
/// that drives along beside the vehicle in a bend, late stamps, a wrong gyro turn gradually, and are not taken for it.
/// A LiDAR that does not come to rest shakes, and its scans are not used.
///
/// A function of the calls. Pure; one thread. Counters: faults.lidar.turned_in_mount, faults.lidar.shakes.
class MountYaw {
 public:
  static constexpr double kTurn = 0.0175;                   ///< rad, smallest turn that is detected
  static constexpr std::int64_t kUnobserved = 10'000'000;   ///< us, since it last turned
  static constexpr std::int64_t kReportedFor = 60'000'000;  ///< us after the last turn, if it is back where it was

  /// A scan, and what odometry says of it.
  struct Observation {
    std::int64_t utime = 0;                            ///< us, its end
    const std::vector<scan::LidarPoint>* points = {};  ///< de-skewed, in base_link, with yaw() corrected
    Pose T_odom_base = Pose::Identity();
    bool turn_confirmed = false;  ///< wheels and gyro agree on the turn
  };
  /// What the scan shows.
  enum class Result {
    kStable,     ///< the LiDAR looks where it did
    kUncertain,  ///< it may be turning: the scan should not be used
    kTurned,     ///< it has turned: yaw() is new
  };

  /// `lidar`: position in base_link, m.
  explicit MountYaw(const Eigen::Vector3d& lidar) : lidar_(lidar) {}

  /// Takes the next scan.
  Result add(const Observation& look);
  /// Takes the next scan instead, ended at `utime`, us, if nothing measures the vehicle's turn. A LiDAR that shook is
  /// believed to be still after kUnobserved.
  Result skip(std::int64_t utime);
  /// rad, to the left: how far the LiDAR has turned since the start.
  [[nodiscard]] double yaw() const { return yaw_; }
  [[nodiscard]] bool shakes() const { return state_ == State::kShakes; }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  /// How the LiDAR is believed to stand in its mount. add() goes from one to the next.
  enum class State {
    kFirm,      ///< it is still
    kInDoubt,   ///< it may be turning since before_
    kOdometry,  ///< what turns may be odometry: scans are used until they show no turn
    kShakes,    ///< it does not come to rest
  };
  struct Earlier {
    Pose T_odom_base;
    AzimuthProfile profile;
  };
  /// What a scan shows, compared with the one before the last.
  struct Comparison {
    bool turns = false;   ///< by more than kTurn
    bool still = false;   ///< far less than that
    bool creeps = false;  ///< it had turned gradually, before: not in its mount
  };
  [[nodiscard]] std::optional<AzimuthProfile::Turn> turn_since(const Earlier& earlier, const UprightPoints& upright,
                                                               const Observation& look) const;
  Comparison note(const AzimuthProfile::Turn& turn);
  Result begin_to_doubt(Earlier before);
  Result end_doubt(const UprightPoints& upright, const Observation& look);
  Result give_up(bool turn_confirmed);
  Result begin_to_shake();
  Result settle();
  [[nodiscard]] Result as_before() const;
  void interrupt();
  [[nodiscard]] double creep();

  Eigen::Vector3d lidar_;
  State state_ = State::kFirm;
  std::int64_t utime_ = 0;                                // us, of the last scan
  std::deque<Earlier> earlier_;                           // the last two scans
  std::optional<Earlier> before_;                         // kInDoubt: the scan before those that are in doubt,
  std::int64_t unsure_since_ = 0;                         // us, and the first of these
  int still_ = 0;                                         // scans in a row that show no turn,
  std::int64_t still_since_ = 0;                          // us, and the first of them
  std::deque<std::pair<std::int64_t, double>> creeping_;  // us, rad: turn between two scans, for a second
  double usual_ = 0;                                      // residual of two scans that show no turn, lately
  std::int64_t turning_ = 0;                              // us, the last scan that shows a turn
  std::int64_t shook_ = 0;                                // us; 0: never
  double yaw_ = 0;
  double quiet_yaw_ = 0;            // before turns_
  std::deque<std::int64_t> turns_;  // us, of the last seconds
  double largest_ = 0;              // rad, since the fault was raised
  std::int64_t turned_ = 0;         // us; 0: never
  Counters counters_;
};

}  // namespace curbstone::mapper::mounting
