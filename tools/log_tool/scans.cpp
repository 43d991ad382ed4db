#include "tools/log_tool/scans.hpp"

#include <fmt/format.h>

#include <iterator>
#include <stdexcept>
#include <utility>

#include "common/pcd/pcd_header.hpp"

namespace curbstone::log_tool {

void ScanCollector::take(const lidar_points_t& message) {
  pass(assembler_.add(message));
}

void ScanCollector::finish() {
  pass(assembler_.flush());
}

void ScanCollector::pass(const std::optional<mapper::scan::Scan>& scan) {
  if (!scan || scan->points.empty()) return;
  scan_.revolution = scan->number;
  scan_.utime = scan->start;
  scan_.points.clear();
  for (const mapper::scan::LidarPoint& p : scan->points)
    scan_.points.push_back({p.position.x(), p.position.y(), p.position.z(), static_cast<float>(p.intensity),
                            static_cast<float>(p.ring), p.time});
  on_scan_(scan_);
}

std::int64_t ScanCollector::left_out() const {
  return assembler_.counters()["dropped.late"] + assembler_.counters()["dropped.duplicate"];
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

std::optional<std::pair<LoggedPath::Poses::const_iterator, LoggedPath::Poses::const_iterator>> LoggedPath::around(
    std::int64_t utime) const {
  constexpr std::int64_t kMaxTimeDifference = 1'000'000;  // us
  constexpr double kStands = 0.2;                         // m: MAP_TRAJECTORY has no poses of a vehicle that stands
  const auto after = poses_.lower_bound(utime);
  if (after == poses_.end()) return std::nullopt;
  if (after->first == utime) return std::pair(after, after);
  if (after == poses_.begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (after->first - before->first > kMaxTimeDifference &&
      (after->second.translation() - before->second.translation()).norm() > kStands)
    return std::nullopt;
  return std::pair(before, after);
}

std::optional<Pose> LoggedPath::at(std::int64_t utime) const {
  const auto pair = around(utime);
  if (!pair) return std::nullopt;
  const auto& [before, after] = *pair;
  if (before == after) return after->second;
  return interpolate(before->second, after->second,
                     static_cast<double>(utime - before->first) / static_cast<double>(after->first - before->first));
}

ScanPcdFile::ScanPcdFile(const std::string& file, std::size_t count)
    : file_(file), out_(file, std::ios::binary), missing_(count) {
  constexpr PcdField kFields[] = {{"x"}, {"y"}, {"z"}, {"intensity"}, {"ring"}, {"t"}};
  out_ << pcd_header(kFields, count);
  if (!out_) throw std::runtime_error(fmt::format("{}: cannot be written", file_));
}

void ScanPcdFile::add(const std::vector<ScanPoint>& points) {
  if (points.size() > missing_) throw std::runtime_error("the log has grown: copy it first, or end its recorder");
  missing_ -= points.size();
  out_.write(reinterpret_cast<const char*>(points.data()),
             static_cast<std::streamsize>(points.size() * sizeof(ScanPoint)));
  if (!out_) throw std::runtime_error(fmt::format("{}: cannot be written", file_));
}

void ScanPcdFile::finish() {
  if (missing_ != 0) throw std::runtime_error("the log has shrunk while it was read");
  if (!out_.flush()) throw std::runtime_error(fmt::format("{}: cannot be written", file_));
}

}  // namespace curbstone::log_tool
