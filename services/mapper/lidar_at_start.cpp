#include "services/mapper/lidar_at_start.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace curbstone::mapper {

std::optional<std::string> LidarAtStart::add(const Look& look) {
  if (!yaw_at_start_) return {};
  if (look.T_map_base.translation().norm() > kStartOfDrive) {
    yaw_at_start_.reset();
    return {};
  }
  if (look.is_upside_down && !turned_over_) {
    turn_over();
    return "the LiDAR is upside down by what vehicle.lidar says";
  }
  if (!look.T_odom_base) {
    yaw_at_start_->interrupt();
    return {};
  }
  const std::optional<double> yaw = yaw_at_start_->add(look.utime, *look.points, *look.T_odom_base);
  if (!yaw) return {};
  turn(*yaw);
  return "the LiDAR looks aside of what vehicle.lidar says";
}

/// `yaw`, rad: by which it looks to the left of what the file says.
void LidarAtStart::turn(double yaw) {
  counters_.add("lidar_turned");
  turned_ += yaw;
  lidar_[5] += yaw;
  yaw_at_start_.reset();
  if (std::abs(yaw) > kLargeYaw) yaw_at_start_.emplace(position_, mounting::YawAtStart::kWrongAgain);
}

void LidarAtStart::turn_over() {
  counters_.add("lidar_turned_over");
  turned_over_ = true;
  lidar_[3] += std::numbers::pi;
  yaw_at_start_.emplace(position_);
}

void LidarAtStart::add_faults(std::vector<std::string>& faults) const {
  if (turned_over_)
    faults.emplace_back(
        "LiDAR: it is upside down by what vehicle.lidar says, and is used so: add 3.1416 to its roll there");
  if (turned_ == 0) return;
  faults.push_back(fmt::format(
      "LiDAR: by the first metres driven it looks {:.1f} deg to the {} of what vehicle.lidar says, and is used so: "
      "straighten it, or set its yaw to {:.3f}",
      std::abs(turned_) * 180 / std::numbers::pi, turned_ > 0 ? "left" : "right",
      std::remainder(lidar_[5], 2 * std::numbers::pi)));
}

}  // namespace curbstone::mapper
