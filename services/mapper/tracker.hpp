#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/counters.hpp"
#include "common/geometry.hpp"
#include "services/mapper/deskew.hpp"
#include "services/mapper/map_node.hpp"
#include "services/mapper/mapper_config.hpp"
#include "services/mapper/motion_expectation.hpp"
#include "services/mapper/motion_filter.hpp"
#include "services/mapper/odometry_history.hpp"
#include "services/mapper/registration.hpp"
#include "services/mapper/revolution.hpp"
#include "services/mapper/revolution_fitter.hpp"
#include "services/mapper/unsteadiness.hpp"

namespace curbstone {

/// How far the pose can be trusted.
enum class Fix {
  kTracking,   ///< revolution after revolution fits the map
  kTentative,  ///< found again; a few more must fit before the map takes anything
  kLost,       ///< only a guess
};

/// What the tracker made of one revolution.
struct Tracked {
  std::int64_t utime = 0;  ///< us, its end
  Pose T_map_base = Pose::Identity();
  RegistrationResult registration;  ///< covariance in base_link axes, with that of the motion where it was a guess
  Fix fix = Fix::kTracking;
  bool registered = false;
  bool with_odometry = false;
  bool stationary = false;
  bool began = false;              ///< with this revolution, or anew
  bool anew = false;               ///< the map for registration is empty: odometry alone led here
  bool maps = false;               ///< the map may take it
  std::vector<LidarPoint> points;  ///< de-skewed, in base_link
  /// Without odometry a revolution has its motion from the next: the very first, when the second has proved it.
  struct Earlier {
    std::vector<LidarPoint> points;
    Pose T_map_base;
    std::int64_t utime;
  };
  std::optional<Earlier> first;
};

/// Follows the vehicle through the map for registration, which it keeps: de-skew, expect, register, judge. A function
/// of the sequence of calls alone. Pure; one thread.
///
/// Counters: revolutions, keyframes, refused.sparse, refused.time, refused.not_converged, refused.overlap,
/// refused.inliers, refused.residual, refused.jump, odometry.not_believed, without_odometry, lost.blind (no sensor told
/// of the motion for too long), lost.refused (nothing fitted for too long), found, began_anew (on odometry alone).
class Tracker {
 public:
  explicit Tracker(const MapperConfig& config);

  /// Takes the next revolution; nothing when it cannot be placed in time (once more, late, longer than a second, ended
  /// before it began, the first after a gap or a jump of the clock) or holds too few points that can be measurements.
  /// Such changes nothing.
  [[nodiscard]] std::optional<Tracked> track(const Revolution& revolution, const OdometryHistory& odometry);

  [[nodiscard]] bool started() const { return last_.has_value(); }
  [[nodiscard]] Fix fix() const { return fix_; }
  [[nodiscard]] const Pose& T_map_base() const { return last_->T_map_base; }
  /// How far off the pose may be, m, since the last revolution that fitted...
  [[nodiscard]] double doubt() const { return doubt_; }
  /// ...which ended then; us.
  [[nodiscard]] std::int64_t fitted() const { return fitted_; }

  /// The vehicle is somewhere else than was thought: lost becomes tentative.
  void relocate(const Pose& T_map_base);
  /// The first revolution is not where the map begins, but about here in a map that is known. Lost until relocate().
  void begin_at(const Pose& T_map_base, double doubt);
  /// The map for registration is made anew from these nodes, and the vehicle is here in it.
  void rebuild(const std::vector<const MapNode*>& nodes, const Pose& T_map_base);
  /// A node's surroundings come back into the map for registration.
  void recall(const MapNode& node) { fitter_.map().recall(node); }
  /// Bounds the map for registration once the vehicle has gone far enough: true when what is farther than the window
  /// has been forgotten.
  bool forget_far();
  [[nodiscard]] double window() const { return fitter_.map().window(); }

  /// Voxels of the map that registration keeps; bounded by its window.
  [[nodiscard]] std::size_t registration_size() const { return fitter_.map().size(); }
  [[nodiscard]] const Counters& counters() const { return counters_; }
  /// Revolutions in a row that could not be registered.
  [[nodiscard]] int refused_in_a_row() const { return refused_in_a_row_; }

 private:
  struct Last {
    std::int64_t end = 0;
    Pose T_map_base = Pose::Identity();
  };
  /// A revolution in the map, and whether that is so.
  struct Attempt {
    Fit fit;
    std::string refusal;  // the counter of why it is not believed; empty if it is
    bool believed = false;
  };

  [[nodiscard]] bool follows(const Revolution& revolution, const OdometryHistory& odometry);
  [[nodiscard]] RecentMotion recent() const { return {last_->end, motion_.twist(), stride_}; }
  [[nodiscard]] Departure departure() const { return {last_->end, last_->T_map_base, drift_}; }
  [[nodiscard]] Attempt attempt(const Revolution& revolution, const OdometryHistory& odometry);
  [[nodiscard]] Attempt judged(Fit fit) const;
  [[nodiscard]] std::string refusal(const Fit& fit) const;
  [[nodiscard]] Tracked start(const Revolution& revolution, const OdometryHistory& odometry);
  [[nodiscard]] bool finish_start(Tracked& tracked);
  void judge(const Fit& fit, Tracked& tracked);
  [[nodiscard]] bool may_begin_anew(const Fit& fit, const Tracked& tracked) const;
  void conclude(const Fit& fit, Tracked& tracked);
  void learn_motion(const Fit& fit, const Tracked& tracked, const Pose& moved);
  void insert(const Tracked& tracked);

  MapperConfig config_;
  RevolutionFitter fitter_;
  std::optional<Last> last_;
  std::optional<Pose> known_start_;
  std::optional<std::int64_t> broken_;    // us, the end of a revolution that did not follow the one before
  std::optional<Revolution> first_;       // until its motion is known, where there is no odometry
  std::vector<LidarPoint> first_points_;  // of it, de-skewed
  Fix fix_ = Fix::kTracking;
  int fitting_ = 0;            // revolutions in a row, while tentative
  bool blind_ = false;         // lost, and not even odometry says how far
  double since_fitted_m_ = 0;  // moved by odometry since the last one that fitted
  double doubt_ = 0;           // m, that the pose may be off by since then
  std::int64_t fitted_ = 0;    // us, the end of the last revolution that fitted
  Twist twist_;                // over the last revolution
  MotionFilter motion_;        // until now
  double stride_ = 0.05;       // s from revolution to revolution
  int steady_ = 0;             // revolutions in a row that fitted and tell of the motion between them
  Unsteadiness unsteadiness_;
  Pose T_map_keyframe_ = Pose::Identity();  // when the registration map last took a revolution
  Matrix6 drift_ = Matrix6::Zero();  // covariance of the pose at the end of the last revolution, if that was refused
  int refused_in_a_row_ = 0;
  Counters counters_;
};

}  // namespace curbstone
