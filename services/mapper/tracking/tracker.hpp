#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/config/vehicle.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/config/registration_config.hpp"
#include "services/mapper/config/tracker_config.hpp"
#include "services/mapper/registration/registration.hpp"
#include "services/mapper/scan/deskew.hpp"
#include "services/mapper/scan/keyframe.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan.hpp"
#include "services/mapper/tracking/acceptance.hpp"
#include "services/mapper/tracking/motion_expectation.hpp"
#include "services/mapper/tracking/motion_filter.hpp"
#include "services/mapper/tracking/motion_jitter_covariance.hpp"
#include "services/mapper/tracking/pair_motion.hpp"
#include "services/mapper/tracking/pose_trust.hpp"
#include "services/mapper/tracking/scan_matcher.hpp"
#include "services/mapper/tracking/turn_check.hpp"
#include "services/mapper/tracking/way_check.hpp"

namespace curbstone::mapper::tracking {

/// What the tracker made of one scan.
struct Tracked {
  std::int64_t utime = 0;  ///< us, its end
  Pose T_map_base = Pose::Identity();
  std::optional<Pose> T_map_base_by_scan;  ///< as registration has it, though odometry may be believed rather
  /// Covariance in base_link axes: with that of the motion where it was a guess; of what led here where the scan did
  /// not fit.
  registration::RegistrationResult registration;
  Fix fix = Fix::kTracking;
  bool registered = false;
  bool with_odometry = false;
  bool stationary = false;
  bool began = false;         ///< with this scan, or anew
  bool anew = false;          ///< the map for registration is empty: odometry alone led here
  bool sparse = false;        ///< too few points to be placed by: odometry led here
  bool maps = false;          ///< the map may take it
  scan::SharedPoints points;  ///< de-skewed, in base_link; never null
  /// Without odometry a scan has its motion from the next: the very first, when the second has proved it.
  struct Earlier {
    scan::SharedPoints points;
    Pose T_map_base;
    std::int64_t utime;
  };
  std::optional<Earlier> first;
};

/// Follows the vehicle through the map for registration, which it keeps: de-skew, expect, register, judge. A function
/// of the sequence of calls alone. Pure; one thread.
///
/// Counters: revolutions, keyframes, refused.sparse, refused.time, refused.not_converged, refused.overlap,
/// refused.inliers, refused.residual, refused.jump, refused.turn (wheels and gyro say otherwise),
/// odometry.not_believed, without_odometry, lost.blind (no sensor measured the motion for too long), bridged (nor did
/// any, but odometry says the same as the LiDAR of where the vehicle is now), lost.refused (nothing fitted for too
/// long), found, began_anew (on odometry alone).
class Tracker {
 public:
  /// `keeps_map` false: the registration map is an earlier drive's, and takes no scans.
  Tracker(const config::TrackerConfig& config, const config::RegistrationConfig& registration,
          const VehicleConfig& vehicle, bool keeps_map);

  /// Takes the next scan; nothing when it cannot be placed in time (once more, late, longer than a second, ended
  /// before it began, the first after a gap or a jump of the clock) or holds too few points that can be measurements
  /// and odometry does not lead on. Such changes nothing.
  [[nodiscard]] std::optional<Tracked> track(const scan::Scan& scan, const scan::OdometryHistory& odometry);

  [[nodiscard]] bool started() const { return last_.has_value(); }
  [[nodiscard]] Fix fix() const { return trust_.fix(); }
  [[nodiscard]] const Pose& T_map_base() const { return last_->T_map_base; }
  /// Lost, and no measurement leads here from the last scan that fitted.
  [[nodiscard]] bool adrift() const { return trust_.adrift(); }
  /// How far off the pose may be, m, since the last scan that fitted...
  [[nodiscard]] double doubt() const { return trust_.doubt(); }
  /// ...which ended then; us.
  [[nodiscard]] std::int64_t fitted() const { return trust_.fitted(); }

  /// The vehicle is somewhere else than was thought: lost becomes tentative.
  void relocate(const Pose& T_map_base);
  /// The first scan is not where the map begins, but about here in a map that is known. Lost until relocate().
  void begin_at(const Pose& T_map_base, double doubt);
  /// Goes on with the drive of another: the vehicle is at `T_map_base` at `utime`, us, by odometry over `path` m since
  /// it was last found. `twist`: how it moves, for a first scan without odometry. Before the first scan.
  void resume(std::int64_t utime, const Pose& T_map_base, double path, const scan::Twist& twist = {});
  /// The map for registration is made anew from these nodes, and the vehicle is here in it.
  void rebuild(const std::vector<const scan::Keyframe*>& nodes, const Pose& T_map_base);
  /// A node's surroundings come back into the map for registration.
  void recall(const scan::Keyframe& node) { matcher_.map().recall(node); }
  /// Bounds the map for registration once the vehicle has gone far enough: true when what is farther than the window
  /// has been forgotten.
  bool forget_far();
  [[nodiscard]] double window() const { return matcher_.map().window(); }

  /// Voxels of the map that registration keeps; bounded by its window.
  [[nodiscard]] std::size_t registration_size() const { return matcher_.map().size(); }
  [[nodiscard]] const Counters& counters() const { return counters_; }
  /// Whether odometry goes where the scans do. While it is denied the tracker goes by scans alone.
  [[nodiscard]] const WayCheck& way() const { return way_; }
  /// Of it, and of scans that show too little.
  void add_faults(std::vector<std::string>& faults) const;
  /// Whether a scan was refused because it turned otherwise than wheels and gyro, and none was believed since.
  [[nodiscard]] bool turns_otherwise() const { return turns_otherwise_; }
  /// us, when one was refused so last; 0: none was.
  [[nodiscard]] std::int64_t turned_otherwise() const { return turned_otherwise_; }
  /// Scans in a row that could not be registered.
  [[nodiscard]] int refused_in_a_row() const { return trust_.refused_in_a_row(); }

 private:
  struct Last {
    std::int64_t end = 0;
    Pose T_map_base = Pose::Identity();
    std::optional<Pose> T_odom_base = std::nullopt;  // as odometry had it, or had it last
    std::int64_t odometry_utime = 0;                 // us, when that was
  };
  /// A scan in the map, and whether that is so.
  struct Attempt {
    Fit fit;
    std::string refusal{};  // the counter of why it is not believed; empty if it is
    bool believed = false;
    bool sparse = false;  // too few points to try
  };

  [[nodiscard]] bool follows(const scan::Scan& scan, const scan::OdometryHistory& odometry);
  [[nodiscard]] RecentMotion recent() const { return {last_->end, motion_.twist(), stride_}; }
  [[nodiscard]] Departure departure() const { return {last_->end, last_->T_map_base, trust_.drift()}; }
  [[nodiscard]] std::optional<Tracked> pass_over(const scan::Scan& scan, const scan::OdometryHistory& odometry);
  [[nodiscard]] Attempt attempt(const scan::Scan& scan, const scan::OdometryHistory& odometry);
  [[nodiscard]] std::optional<Attempt> attempt_across(const Departure& from, const scan::Scan& scan,
                                                      const scan::OdometryHistory& odometry);
  [[nodiscard]] Attempt attempt_without_odometry(const Departure& from, const scan::Scan& scan);
  [[nodiscard]] Attempt attempt_from_afar(const Departure& from, const scan::Scan& scan);
  [[nodiscard]] bool contradicts_odometry(const Attempt& found, const scan::Scan& scan,
                                          const scan::OdometryHistory& odometry) const;
  [[nodiscard]] Attempt by_odometry(const scan::Scan& scan, const scan::OdometryHistory& odometry) const;
  [[nodiscard]] Attempt judged(Fit fit) const { return judged(std::move(fit), certainty()); }
  [[nodiscard]] Attempt judged(Fit fit, Certainty guess) const;
  [[nodiscard]] Certainty certainty() const;
  [[nodiscard]] Tracked start(const scan::Scan& scan, const scan::OdometryHistory& odometry);
  [[nodiscard]] std::optional<Tracked::Earlier> prove_start(const Fit& second);
  void forget_start();
  [[nodiscard]] Tracked conclude(std::int64_t utime, Attempt found);
  void learn_motion(const Attempt& found, const Pose& moved, double stride);
  void begin_anew();
  void check_way(const Tracked& tracked, const scan::OdometryHistory& odometry);
  void go_by_scans(const WayCheck::Pair& pair, const Pose& T_odom_base);
  void note_turn(const Tracked& tracked, const scan::OdometryHistory& odometry);
  void note_odometry(const Last& before, const scan::OdometryHistory& odometry);
  void insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base);

  config::TrackerConfig config_;
  bool keeps_map_;
  ScanMatcher matcher_;
  std::optional<Last> last_;
  std::optional<Pose> known_start_;
  std::optional<std::int64_t> broken_;          // us, the end of a scan that did not follow the one before
  std::optional<scan::Scan> first_;             // until its motion is known, where there is no odometry
  std::vector<scan::LidarPoint> first_points_;  // of it, de-skewed
  PoseTrust trust_;
  TurnCheck turns_;
  PairMotion pairs_;
  WayCheck way_;
  std::optional<Last> agreed_;               // when odometry last went where the scans do, in this map
  const scan::OdometryHistory no_odometry_;  // where it is denied
  double lidar_yaw_;
  bool turns_otherwise_ = false;  // a scan did, against odometry, and none was believed since
  std::int64_t turned_otherwise_ = 0;
  int sparse_in_a_row_ = 0;
  scan::Twist twist_;     // over the last scan
  MotionFilter motion_;   // until now
  double stride_ = 0.05;  // s from scan to scan
  int steady_ = 0;        // scans in a row that fitted and tell of the motion between them
  MotionJitterCovariance motion_jitter_;
  Pose T_map_keyframe_ = Pose::Identity();  // when the registration map last took a scan
  Counters counters_;
};

}  // namespace curbstone::mapper::tracking
