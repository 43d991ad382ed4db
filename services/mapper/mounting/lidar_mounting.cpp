#include "services/mapper/mounting/lidar_mounting.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::mapper::mounting {
namespace {

constexpr double kMaxScanInterval = 0.3;  // s: largest interval between revolutions from which the motion is computed
constexpr double kSampleSpacing = 0.5;    // m
constexpr double kMaxLateralAcceleration = 0.5;  // m/s^2: above it the vehicle leans in the bend
constexpr double kMirrored = -0.5;               // LiDAR's turn divided by odometry's

bool beyond(double value, double limit, bool was) {
  return std::abs(value) > (was ? LidarMounting::kSettled : 1.0) * limit;
}

double degrees(double rad) {
  return rad * 180 / std::numbers::pi;
}

}  // namespace

void LidarMounting::interrupt() {
  travel_.interrupt();
  arm_.interrupt();
  utime_ = 0;
  looked_.setConstant(1e9);
}

void LidarMounting::add(const RegisteredScan& scan) {
  const double seconds = scan::seconds(utime_, scan.utime);
  const Pose moved = T_map_base_.inverse() * scan.T_map_base;
  const bool goes_on = seconds > 0 && seconds < kMaxScanInterval;
  utime_ = scan.utime;
  T_map_base_ = scan.T_map_base;
  if (scan.T_odom_base && scan.is_fully_constrained) {
    travel_.add(scan.T_map_base, *scan.T_odom_base);
    arm_.add(scan.utime, scan.T_map_base, *scan.T_odom_base);
  } else {
    travel_.interrupt();
    arm_.interrupt();
  }
  const double sideways = goes_on ? moved.translation().norm() * angle_of(moved) / (seconds * seconds) : 1e9;
  if ((scan.T_map_base.translation() - looked_).norm() < kSampleSpacing || sideways > kMaxLateralAcceleration) return;
  looked_ = scan.T_map_base.translation();
  ground_.add(*scan.points);
  judge();
}

void LidarMounting::set_turns_opposite(bool opposite) {
  if (opposite == turns_opposite_) return;
  turns_opposite_ = opposite;
  judge_mirrored();
}

void LidarMounting::judge_mirrored() {
  const auto turning = travel_.turning();
  const bool before = wrong_.mirrored;
  wrong_.mirrored = turning ? *turning < kMirrored : turns_opposite_;
  if (wrong_.mirrored && !before) counters_.add("faults.lidar.mirrored");
}

bool LidarMounting::is_beyond_ahead() const {
  return excess_.bends > 0 &&
         beyond(excess_.by.x(), kAhead + kFewBends / static_cast<double>(excess_.bends), wrong_.place);
}

bool LidarMounting::is_beyond_aside() const {
  return excess_.bends > 0 &&
         beyond(excess_.by.y(), kAside + kFewBends / static_cast<double>(excess_.bends), wrong_.place);
}

void LidarMounting::judge_place() {
  const auto straight = travel_.straight();
  const auto excess = straight && !stamps_are_wrong_ ? arm_.excess(*straight) : std::nullopt;
  if (!excess) return;
  excess_ = *excess;
  const bool before = wrong_.place;
  wrong_.place = is_beyond_ahead() || is_beyond_aside();
  if (wrong_.place && !before) counters_.add("faults.lidar.displaced");
}

/// The way by LiDAR is as many times too long as the ranges are; length_error is that of odometry's against it.
void LidarMounting::judge_ranges() {
  const auto straight = travel_.straight();
  const auto plane = ground_.plane();
  const double lidar = vehicle_.T_base_lidar().translation().z();
  if (!straight || !plane || lidar <= 0) return;
  const bool before = wrong_.ranges;
  const double by_way = 1 / (1 + straight->length_error) - 1;
  const double by_ground = -plane->height / lidar;
  const double differ = std::abs(by_way - by_ground);
  wrong_.ranges = !wrong_.tilt && beyond(by_way, kRanges, before) && beyond(by_ground, kRanges, before) &&
                  beyond(plane->height, kRangesDepth, before) &&
                  differ < std::max(kRangesAgree, kRangesAlike * std::abs(by_way));
  range_error_ = by_way;
  if (wrong_.ranges && !before) counters_.add("faults.lidar.ranges");
}

void LidarMounting::judge() {
  const Wrong before = wrong_;
  judge_mirrored();
  judge_place();
  if (const auto straight = travel_.straight()) {
    straight_ = *straight;
    wrong_.yaw = beyond(straight->heading_offset, kYaw, before.yaw);
    wrong_.size = beyond(straight->length_error, kLength, before.size);
  }
  if (const auto plane = ground_.plane()) {
    plane_ = *plane;
    wrong_.tilt = beyond(plane->along, kPitch, before.tilt) || beyond(plane->across, kRoll, before.tilt);
    wrong_.height = beyond(plane->height, kHeight, before.height);
  }
  judge_ranges();
  if (wrong_.ranges) wrong_.height = wrong_.size = false;
  if (wrong_.tilt && !before.tilt) counters_.add("faults.lidar.tilted");
  if (wrong_.height && !before.height) counters_.add("faults.lidar.height");
  if (wrong_.yaw && !before.yaw) counters_.add("faults.lidar.turned");
  if (wrong_.size && !before.size) counters_.add("faults.wheels.size");
}

std::vector<double> LidarMounting::lidar() const {
  const Pose T_base_lidar = vehicle_.T_base_lidar();
  const Eigen::Vector3d up = Eigen::Vector3d(-plane_.along, -plane_.across, 1.0).normalized();
  const Eigen::Matrix3d level = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(-straight_.heading_offset, Eigen::Vector3d::UnitZ()) * level * T_base_lidar.linear();
  const Eigen::Vector3d rpy = roll_pitch_yaw(R);
  Eigen::Vector3d at = T_base_lidar.translation();
  const double above = (at.z() - plane_.height - plane_.along * at.x() - plane_.across * at.y()) * up.z();
  const auto rounded = [](double rad) { return std::round(rad * 1000) / 1000 + 0.0; };  // no -0.000
  if (is_beyond_ahead()) at.x() -= excess_.by.x();
  if (is_beyond_aside()) at.y() -= excess_.by.y();
  const auto in_cm = [](double m) { return std::round(m * 100) / 100 + 0.0; };
  return {in_cm(at.x()), in_cm(at.y()), in_cm(above), rounded(rpy.x()), rounded(rpy.y()), rounded(rpy.z())};
}

std::string LidarMounting::place_fault() const {
  std::string what;
  const Eigen::Vector2d& by = excess_.by;
  if (is_beyond_ahead())
    what += fmt::format(", is {:.2f} m too far {}", std::abs(by.x()), by.x() > 0 ? "back" : "ahead");
  if (is_beyond_aside())
    what += fmt::format(", is {:.2f} m too far to the {}", std::abs(by.y()), by.y() > 0 ? "right" : "left");
  return what;
}

void LidarMounting::add_faults(std::vector<std::string>& faults) const {
  if (wrong_.mirrored) {
    faults.emplace_back(
        "LiDAR: it turns the other way than odometry: upside down is a roll of 3.1416 in vehicle.lidar; else are its "
        "azimuths or axes mirrored, or the IMU's turned?");
    return;
  }
  if (wrong_.tilt || wrong_.height || wrong_.yaw || wrong_.place) {
    std::string what;
    if (wrong_.tilt)
      what += fmt::format(", leans by {:.1f} deg", degrees(std::atan(std::hypot(plane_.along, plane_.across))));
    if (wrong_.yaw) what += fmt::format(", looks {:.1f} deg aside", degrees(std::abs(straight_.heading_offset)));
    if (wrong_.height)
      what += fmt::format(", is {:.2f} m too {}", std::abs(plane_.height), plane_.height > 0 ? "low" : "high");
    if (wrong_.place) what += place_fault();
    const std::vector<double> is = lidar();
    faults.push_back(
        fmt::format("LiDAR: not where vehicle.lidar says, by the ground and the way driven: it{}: straighten it, or "
                    "set vehicle.lidar: "
                    "[{:.2f}, {:.2f}, {:.2f}, {:.3f}, {:.3f}, {:.3f}]",
                    what.substr(1), is[0], is[1], is[2], is[3], is[4], is[5]));
  }
  if (wrong_.ranges)
    faults.push_back(fmt::format(
        "LiDAR: its ranges are {:.1f} % too {}, by the ground below it and the way driven, and so is the map: check "
        "lidar.model and the device's range calibration; or are both the height in vehicle.lidar and "
        "vehicle.wheel_radius wrong?",
        100 * std::abs(range_error_), range_error_ > 0 ? "long" : "short"));
  if (wrong_.size)
    faults.push_back(
        fmt::format("WHEELS: odometry's way is {:.1f} % {} than the LiDAR's: vehicle.wheel_radius is {:.3f} m or {}",
                    100 * std::abs(straight_.length_error), straight_.length_error > 0 ? "longer" : "shorter",
                    wheel_radius(), straight_.length_error > 0 ? "less" : "more"));
}

}  // namespace curbstone::mapper::mounting
