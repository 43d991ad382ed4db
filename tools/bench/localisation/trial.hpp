#pragma once

#include <optional>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "services/localizer/localizer_node.hpp"
#include "tools/bench/localisation/recorded_drive.hpp"
#include "tools/localise/pose_errors.hpp"

namespace curbstone::bench::localisation {

/// What the localizer said of a revolution.
struct Said {
  std::int64_t utime = 0;  ///< us, in the drive
  bool sure = false;       ///< not LOST
  bool ambiguous = false;
  double error = 0;  ///< m; infinite where the map is of another place
  double ms = 0;     ///< of CPU, of the messages that the revolution took
  [[nodiscard]] bool right() const { return sure && error < 0.5; }
  [[nodiscard]] bool wrong() const { return sure && !right(); }
};

/// A localizer that hears pieces of a drive.
class Trial {
 public:
  /// No truth: the map is of another place. Both outlive the trial.
  Trial(const localizer::LocalizerConfig& config, const RecordedDrive& drive, const localise::TrueMapPose* truth);

  /// The drive from one time to another; a second piece comes as if the vehicle were carried there while it stood.
  void hear(std::int64_t from, std::int64_t until);
  [[nodiscard]] const std::vector<Said>& said() const { return said_; }

 private:
  void take_up(std::int64_t from);
  void hear(const lidar_points_t& message);
  void hear(const odometry_t& message);

  const RecordedDrive& drive_;
  const localise::TrueMapPose* truth_;
  LocalBus bus_;
  localizer::LocalizerNode node_;
  std::vector<Said> said_;
  double ms_ = 0;
  // What carries a later piece on to where the one before ended.
  std::int64_t late_ = 0;  // us
  std::int32_t packets_ = 0, revolutions_ = 0;
  Pose T_heard_odom_ = Pose::Identity();
  std::optional<lidar_points_t> last_lidar_;
  std::optional<odometry_t> last_odometry_;
};

}  // namespace curbstone::bench::localisation
