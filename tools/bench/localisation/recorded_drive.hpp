#pragma once

#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <string>
#include <variant>
#include <vector>

#include "services/ekf/base/ekf_config.hpp"

namespace curbstone::bench::localisation {

using DriveMessage = std::variant<lidar_points_t, odometry_t>;

/// us since the Unix epoch.
[[nodiscard]] std::int64_t time_of(const DriveMessage& message);

/// The input of a localizer in a drive, in the order of a replay: LIDAR_POINTS of the log, and the ODOMETRY that the
/// ekf computes from its IMU and WHEELS.
class RecordedDrive {
 public:
  /// Throws as WatchedLog does, and if the log gives no odometry.
  RecordedDrive(const std::string& log, const ekf::base::EkfConfig& config);

  [[nodiscard]] const std::vector<DriveMessage>& messages() const { return messages_; }
  /// Index of the first message at or after a time.
  [[nodiscard]] std::size_t first_at(std::int64_t utime) const;
  /// Times of the first and the last odometry, us.
  [[nodiscard]] std::int64_t begin() const { return odometry_.front().utime; }
  [[nodiscard]] std::int64_t end() const { return odometry_.back().utime; }
  /// The odometry nearest to a time.
  [[nodiscard]] const odometry_t& odometry_at(std::int64_t utime) const;
  /// m driven since the begin.
  [[nodiscard]] double driven_at(std::int64_t utime) const;

 private:
  [[nodiscard]] std::size_t nearest(std::int64_t utime) const;
  std::vector<DriveMessage> messages_;
  std::vector<odometry_t> odometry_;
  std::vector<double> driven_;
};

}  // namespace curbstone::bench::localisation
