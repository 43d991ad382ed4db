#pragma once

#include <optional>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "services/localizer/localizer_node.hpp"
#include "tools/bench/localisation/recorded_drive.hpp"
#include "tools/localise/pose_errors.hpp"

namespace curbstone::bench::localisation {

/// The localizer's output for a revolution.
struct Said {
  std::int64_t utime = 0;  ///< us, in the drive
  bool sure = false;       ///< not LOST
  bool ambiguous = false;
  double error = 0;  ///< m; infinite if the map is of another place
  double ms = 0;     ///< CPU time of the messages that the revolution took
  [[nodiscard]] bool right() const { return sure && error < 0.5; }
  [[nodiscard]] bool wrong() const { return sure && !right(); }
};

/// Runs a localizer on pieces of a drive.
class Trial {
 public:
  /// `truth` null: the map is of another place. `drive` and `truth` must outlive the trial.
  Trial(const localizer::LocalizerConfig& config, const RecordedDrive& drive, const localise::TrueMapPose* truth);

  /// Feeds the drive from one time to another. At the start of a further piece the vehicle is carried there while
  /// standing.
  void play(std::int64_t from, std::int64_t until);
  [[nodiscard]] const std::vector<Said>& said() const { return said_; }

 private:
  void take_up(std::int64_t from);
  void on_message(const lidar_points_t& message);
  void on_message(const odometry_t& message);

  const RecordedDrive& drive_;
  const localise::TrueMapPose* truth_;
  LocalBus bus_;
  localizer::LocalizerNode node_;
  std::vector<Said> said_;
  double ms_ = 0;
  // Offsets that make a further piece continue where the last one ended.
  std::int64_t late_ = 0;  // us
  std::int32_t packets_ = 0, revolutions_ = 0;
  Pose T_heard_odom_ = Pose::Identity();
  std::optional<lidar_points_t> last_lidar_;
  std::optional<odometry_t> last_odometry_;
};

}  // namespace curbstone::bench::localisation
