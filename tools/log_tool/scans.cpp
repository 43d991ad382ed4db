#include "tools/log_tool/scans.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "common/pcd/pcd_header.hpp"

namespace curbstone::log_tool {

void ScanCollector::take(const lidar_points_t& message) {
  if (message.revolution != scan_.revolution) finish();
  if (scan_.points.empty()) {
    scan_.revolution = message.revolution;
    scan_.utime = message.utime;
  }
  const double late = static_cast<double>(message.utime - scan_.utime) * 1e-6;
  for (std::size_t i = 0; i < message.x.size(); ++i) {
    const ScanPoint point{message.x[i],
                          message.y[i],
                          message.z[i],
                          static_cast<float>(message.intensity[i]),
                          static_cast<float>(message.ring[i]),
                          static_cast<float>(late + static_cast<double>(message.time_offset[i]))};
    if (std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z)) scan_.points.push_back(point);
  }
}

void ScanCollector::finish() {
  if (!scan_.points.empty()) on_scan_(scan_);
  scan_.points.clear();
}

/// An earlier epoch of a message that was overtaken is over; else the mapper's clock was set back.
bool LoggedPath::follow(std::int32_t epoch, std::int64_t utime) {
  if (epoch == epoch_) return true;
  if (epoch < epoch_ && !poses_.empty() && utime <= poses_.rbegin()->first) return false;
  epoch_ = epoch;
  poses_.clear();
  return true;
}

void LoggedPath::take(const map_pose_t& message) {
  const Pose T_map_base = pose_from_arrays(message.map_base_position, message.map_base_orientation);
  if (!is_finite(T_map_base) || !follow(message.epoch, message.utime)) return;
  if ((message.flags & map_pose_t::LOST) == 0) poses_[message.utime] = T_map_base;
}

void LoggedPath::take(const map_trajectory_t& message) {
  if (!follow(message.epoch, message.utime)) return;
  for (std::size_t i = 0; i < message.utimes.size(); ++i) {
    const auto& p = message.positions[i];
    const auto& q = message.orientations[i];
    const std::array<double, 3> position{double{p[0]}, double{p[1]}, double{p[2]}};
    const std::array<double, 4> orientation{double{q[0]}, double{q[1]}, double{q[2]}, double{q[3]}};
    const Pose T_map_base = pose_from_arrays(position.data(), orientation.data());
    if (is_finite(T_map_base)) poses_.try_emplace(message.utimes[i], T_map_base);
  }
}

std::optional<Pose> LoggedPath::at(std::int64_t utime) const {
  constexpr std::int64_t kMaxTimeDifference = 1'000'000;  // us
  constexpr double kStands = 0.2;                         // m: MAP_TRAJECTORY has no poses of a vehicle that stands
  const auto after = poses_.lower_bound(utime);
  if (after == poses_.end()) return std::nullopt;
  if (after->first == utime) return after->second;
  if (after == poses_.begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (after->first - before->first > kMaxTimeDifference &&
      (after->second.translation() - before->second.translation()).norm() > kStands)
    return std::nullopt;
  return interpolate(before->second, after->second,
                     static_cast<double>(utime - before->first) / static_cast<double>(after->first - before->first));
}

void write_scan_pcd(const std::vector<ScanPoint>& points, const std::string& file) {
  constexpr PcdField kFields[] = {{"x"}, {"y"}, {"z"}, {"intensity"}, {"ring"}, {"t"}};
  std::ofstream out(file, std::ios::binary);
  out << pcd_header(kFields, points.size());
  out.write(reinterpret_cast<const char*>(points.data()),
            static_cast<std::streamsize>(points.size() * sizeof(ScanPoint)));
  if (!out.flush()) throw std::runtime_error(fmt::format("{}: cannot be written", file));
}

}  // namespace curbstone::log_tool
