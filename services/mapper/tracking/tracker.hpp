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
#include "services/mapper/mounting/mount_yaw.hpp"
#include "services/mapper/mounting/scale_by_scans.hpp"
#include "services/mapper/mounting/turn_by_scans.hpp"
#include "services/mapper/registration/registration.hpp"
#include "services/mapper/scan/deskew.hpp"
#include "services/mapper/scan/keyframe.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan.hpp"
#include "services/mapper/tracking/acceptance.hpp"
#include "services/mapper/tracking/motion_filter.hpp"
#include "services/mapper/tracking/motion_jitter_covariance.hpp"
#include "services/mapper/tracking/motion_prediction.hpp"
#include "services/mapper/tracking/odometry_check.hpp"
#include "services/mapper/tracking/scan_matcher.hpp"
#include "services/mapper/tracking/scan_to_scan_motion.hpp"
#include "services/mapper/tracking/tracking_state.hpp"
#include "services/mapper/tracking/turn_check.hpp"

namespace curbstone::mapper::tracking {

/// The tracker's result for one scan.
struct Tracked {
  std::int64_t utime = 0;  ///< us, end of the scan
  Pose T_map_base = Pose::Identity();
  std::optional<Pose> T_map_base_by_scan;  ///< by registration, even where odometry's pose is used instead
  /// Its covariance is in base_link axes. It includes the uncertainty of the motion within the scan. If the scan did
  /// not fit, it is the covariance of the prediction since the last scan that did.
  registration::RegistrationResult registration;
  Fix fix = Fix::kTracking;
  bool registered = false;
  bool with_odometry = false;
  bool stationary = false;
  bool began = false;          ///< a drive begins with this scan, or begins again
  bool map_restarted = false;  ///< the registration map begins anew: the pose is by odometry alone
  bool sparse = false;         ///< too few points to register: the pose is by odometry
  bool maps = false;           ///< the map may take the scan
  scan::SharedPoints points;   ///< de-skewed, in base_link; never null
  /// The very first scan, once the second has confirmed it: without odometry its motion is known only then.
  struct Earlier {
    scan::SharedPoints points;
    Pose T_map_base;
    std::int64_t utime;
  };
  std::optional<Earlier> first;
};

/// Tracks the vehicle from scan to scan: predicts, de-skews, registers, judges. Owns the registration map. The result
/// depends on the sequence of calls alone. Pure; one thread.
///
/// Counters: revolutions, keyframes, refused.sparse, refused.time, refused.not_converged, refused.overlap,
/// refused.inliers, refused.residual, refused.jump, refused.turn (contradicts wheels and gyro), refused.mount (the
/// LiDAR turns in its mount), odometry.not_believed, odometry.turn_by_scans (its turn is corrected, without a gyro or
/// where the wheels contradict it), odometry.scale_by_scans (its way is corrected), without_odometry, lost.blind (no
/// sensor measured the motion for too long), bridged (likewise, but odometry and LiDAR agree on the pose now),
/// lost.refused (no scan fitted for too long), found, began_anew (on odometry alone).
class Tracker {
 public:
  /// `keeps_map` false: the registration map is that of an earlier drive and takes no scans.
  Tracker(const config::TrackerConfig& config, const config::RegistrationConfig& registration,
          const VehicleConfig& vehicle, bool keeps_map);

  /// Takes the next scan. Returns nothing, and leaves pose and map unchanged, in two cases. The scan cannot be placed
  /// in time: it is a duplicate, late, longer than a second, ends before it begins, or is the first after a gap or a
  /// jump of the clock. Or it has too few valid points and odometry does not continue the pose.
  [[nodiscard]] std::optional<Tracked> track(const scan::Scan& scan, const scan::OdometryHistory& odometry);

  [[nodiscard]] bool started() const { return last_.has_value(); }
  [[nodiscard]] Fix fix() const { return tracking_state_.fix(); }
  [[nodiscard]] const Pose& T_map_base() const { return last_->T_map_base; }
  /// Lost, and for some of the time since the last scan that fitted no sensor measured the motion.
  [[nodiscard]] bool was_unobserved() const { return tracking_state_.was_unobserved(); }
  /// Possible error of the pose since the last scan that fitted, m.
  [[nodiscard]] double uncertainty() const { return tracking_state_.uncertainty(); }
  /// End of the last scan that fitted, us.
  [[nodiscard]] std::int64_t last_fit() const { return tracking_state_.last_fit(); }

  /// Sets the pose after relocalisation: lost becomes tentative.
  void relocate(const Pose& T_map_base);
  /// The first scan is within `uncertainty` m of this pose in a loaded map, instead of at the map's origin. Lost until
  /// relocate().
  void begin_at(const Pose& T_map_base, double uncertainty);
  /// Continues the drive of another mapper: the vehicle is at `T_map_base` at `utime`, us, by odometry over `path` m
  /// since its last pose there. `twist`: its motion, for a first scan without odometry. Before the first scan.
  void resume(std::int64_t utime, const Pose& T_map_base, double path, const scan::Twist& twist = {});
  /// A registration map of its method, to be filled for replace_map().
  [[nodiscard]] std::unique_ptr<registration::Registration> empty_map() const { return matcher_.empty_map(); }
  /// Replaces the registration map, and sets the vehicle's pose in it.
  void replace_map(std::unique_ptr<registration::Registration> map, const Pose& T_map_base);
  /// Inserts a node's surroundings into the registration map again.
  void insert_keyframe(const scan::Keyframe& node) { matcher_.map().insert_keyframe(node); }
  /// Bounds the registration map once the vehicle has moved far enough. True if voxels outside the window were dropped.
  bool forget_far();
  /// See Registration::levels().
  [[nodiscard]] std::vector<registration::ShapeLevel*> registration_levels() { return matcher_.map().levels(); }
  [[nodiscard]] double window() const { return matcher_.map().window(); }

  /// Number of voxels of the registration map; bounded by its window.
  [[nodiscard]] std::size_t registration_size() const { return matcher_.map().size(); }
  [[nodiscard]] const Counters& counters() const { return counters_; }
  /// Whether odometry and scans agree on the distance driven. While odometry is rejected, the tracker uses scans alone.
  [[nodiscard]] const OdometryCheck& odometry_check() const { return odometry_check_; }
  /// Whether the LiDAR turns in its mount. Its turns are corrected.
  [[nodiscard]] const mounting::MountYaw& mount() const { return mount_; }
  /// Appends the faults of odometry_check(), of mount(), and of scans with too few points.
  void add_faults(std::vector<std::string>& faults) const;
  /// A scan was refused because its turn contradicts wheels and gyro, and no scan was accepted since. Ends when
  /// TurnCheck gives up.
  [[nodiscard]] bool turn_refused() const { return turn_refused_; }
  /// us, end of the last scan that was refused for that reason; 0: none.
  [[nodiscard]] std::int64_t turn_refused_at() const { return turn_refused_at_; }
  /// Number of scans in a row that could not be registered.
  [[nodiscard]] int refused_in_a_row() const { return tracking_state_.refused_in_a_row(); }

 private:
  struct Last {
    std::int64_t end = 0;
    Pose T_map_base = Pose::Identity();
    std::optional<Pose> T_odom_base = std::nullopt;  // by odometry, now or last
    std::int64_t odometry_utime = 0;                 // us, time of T_odom_base
  };
  /// A registered scan, and whether it is accepted.
  struct Attempt {
    Fit fit;
    std::string refusal{};  // counter of the refusal; empty if there is none
    bool believed = false;
    bool sparse = false;  // too few points to register
  };

  [[nodiscard]] bool follows(const scan::Scan& scan, const scan::OdometryHistory& odometry);
  [[nodiscard]] RecentMotion recent() const { return {last_->end, motion_.twist(), stride_}; }
  [[nodiscard]] PreviousPose departure() const { return {last_->end, last_->T_map_base, tracking_state_.drift()}; }
  [[nodiscard]] std::optional<Tracked> process_sparse(const scan::Scan& scan, const scan::OdometryHistory& odometry);
  [[nodiscard]] Attempt attempt(const scan::Scan& scan, const scan::OdometryHistory& odometry);
  [[nodiscard]] std::optional<Attempt> attempt_across_gap(const PreviousPose& from, const scan::Scan& scan,
                                                          const scan::OdometryHistory& odometry);
  [[nodiscard]] Attempt attempt_without_odometry(const PreviousPose& from, const scan::Scan& scan);
  [[nodiscard]] Attempt without_leap(Attempt by_odometry, const PreviousPose& from, const scan::Scan& scan);
  [[nodiscard]] Attempt attempt_multi_start(const PreviousPose& from, const scan::Scan& scan);
  [[nodiscard]] bool turns_steadily(std::int64_t from, std::int64_t to, const scan::OdometryHistory& odometry) const;
  [[nodiscard]] MotionPrediction corrected(MotionPrediction prediction, const scan::Scan& scan,
                                           const scan::OdometryHistory& odometry);
  [[nodiscard]] double turn_error(const scan::SweepMotion& sweep, const scan::Scan& scan,
                                  const scan::OdometryHistory& odometry);
  [[nodiscard]] mounting::MountYaw::Result observe_mount(const std::vector<scan::LidarPoint>& points, std::int64_t end,
                                                         const scan::OdometryHistory& odometry);
  [[nodiscard]] bool contradicts_odometry(const Attempt& found, const scan::Scan& scan,
                                          const scan::OdometryHistory& odometry) const;
  [[nodiscard]] Attempt with_plausible_turn(Attempt by_scan, const scan::Scan& scan,
                                            const scan::OdometryHistory& odometry,
                                            const scan::OdometryHistory& believed);
  [[nodiscard]] Attempt by_odometry(const scan::Scan& scan, const scan::OdometryHistory& odometry) const;
  [[nodiscard]] Attempt judged(Fit fit) const { return judged(std::move(fit), certainty()); }
  [[nodiscard]] Attempt judged(Fit fit, Certainty guess) const;
  [[nodiscard]] Certainty certainty() const;
  [[nodiscard]] Tracked start(const scan::Scan& scan, const scan::OdometryHistory& odometry);
  [[nodiscard]] std::optional<Tracked::Earlier> confirm_start(const Fit& second);
  void forget_start();
  [[nodiscard]] Tracked conclude(std::int64_t utime, Attempt found);
  void learn_motion(const Attempt& found, const Pose& moved, double stride);
  void begin_anew();
  void check_odometry(const Tracked& tracked, const scan::OdometryHistory& odometry);
  void continue_by_scans(const OdometryCheck::Pair& pair);
  void note_turn(const Tracked& tracked, const scan::OdometryHistory& odometry);
  void note_odometry(const Last& before, const scan::OdometryHistory& odometry);
  void insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base);

  config::TrackerConfig config_;
  bool keeps_map_;
  ScanMatcher matcher_;
  std::optional<Last> last_;
  std::optional<Pose> known_start_;
  std::int32_t last_number_ = 0;                // of the scan of last_
  std::optional<std::int64_t> broken_;          // us, end of a scan that did not follow the previous one in time
  std::optional<scan::Scan> first_;             // without odometry, until its motion is known
  std::vector<scan::LidarPoint> first_points_;  // of first_, de-skewed
  TrackingState tracking_state_;
  TurnCheck turns_;
  mounting::MountYaw mount_;
  mounting::TurnByScans turn_by_scans_;
  mounting::ScaleByScans scale_by_scans_;
  ScanToScanMotion pairs_;
  OdometryCheck odometry_check_;
  std::optional<Last> agreed_;               // when odometry and scans last agreed, in this map
  const scan::OdometryHistory no_odometry_;  // used while odometry is rejected
  double lidar_yaw_;
  bool turn_refused_ = false;  // see turn_refused()
  std::int64_t turn_refused_at_ = 0;
  int sparse_in_a_row_ = 0;
  scan::Twist twist_;     // over the last scan
  MotionFilter motion_;   // estimated without odometry
  double stride_ = 0.05;  // s from scan to scan
  int steady_ = 0;        // scans in a row that fitted and show the motion between them
  MotionJitterCovariance motion_jitter_;
  Pose T_map_keyframe_ = Pose::Identity();  // at the last scan that the registration map took
  Counters counters_;
};

}  // namespace curbstone::mapper::tracking
