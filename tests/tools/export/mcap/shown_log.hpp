#pragma once

#include <curbstone/curb_lines_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/marking_lines_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <curbstone/service_status_t.hpp>
#include <string>
#include <vector>

#include "common/log/log_writer.hpp"

namespace curbstone::test {

inline constexpr std::int64_t kLogBegin = 1'700'000'000'000'000;  ///< us

template <class Message>
void append(LogWriter& log, const std::string& channel, const Message& message, std::int64_t log_utime) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  log.write(channel, bytes.data(), static_cast<int>(bytes.size()), log_utime);
}

/// A moment of the drive.
struct ShownMoment {
  int k = 0;               ///< revolutions before it
  std::int64_t utime = 0;  ///< us
  double x = 0;            ///< m driven
  std::int32_t epoch = kLogBegin / 1'000'000;
};

inline map_pose_t shown_pose(const ShownMoment& now) {
  map_pose_t pose{};
  pose.utime = now.utime;
  pose.epoch = now.epoch;
  pose.map_base_position[0] = now.x;
  pose.map_base_orientation[0] = pose.map_odom_orientation[0] = 1;
  return pose;
}

inline lidar_points_t shown_scan(const ShownMoment& now) {
  lidar_points_t scan{};
  scan.utime = now.utime;
  scan.revolution = now.k;
  scan.num_points = 2;
  scan.x = {5, 6};
  scan.y = scan.z = scan.time_offset = {0, 1};
  scan.intensity = scan.ring = {10, 11};
  return scan;
}

inline semantic_tile_t shown_tile(const ShownMoment& now) {
  semantic_tile_t tile{};
  tile.utime = now.utime;
  tile.epoch = now.epoch;
  tile.tile_x = static_cast<std::int32_t>(now.x / 3);
  tile.revision = now.k + 1;
  for (auto& cell : tile.cell_class) cell = semantic_tile_t::ROAD;
  return tile;
}

/// Three points of the dense map.
inline map_points_t shown_cloud(const ShownMoment& now) {
  map_points_t cloud{};
  cloud.utime = now.utime;
  cloud.epoch = now.epoch;
  cloud.num_points = 3;
  cloud.first = cloud.num_points * now.k;
  cloud.x = {1, 2, 3};
  cloud.y = cloud.z = {static_cast<std::int16_t>(now.k), 0, 0};
  cloud.intensity = {7, 8, 9};
  return cloud;
}

/// Lines of one kind, of which there is one.
template <class Lines, class Line>
Lines shown_lines(const ShownMoment& now, const Line& line) {
  Lines lines{};
  lines.utime = now.utime;
  lines.epoch = now.epoch;
  lines.box_min[0] = lines.box_min[1] = -100;
  lines.box_max[0] = lines.box_max[1] = 100;
  lines.num_lines = 1;
  lines.lines = {line};
  return lines;
}

inline curb_lines_t shown_curbs(const ShownMoment& now) {
  curb_line_t line{};
  line.num_points = 2;
  line.x = {0, static_cast<float>(now.x) + 1};
  line.y = {2, 2};
  line.z = line.high_side_x = line.high_side_y = {0, 0};
  line.height = {0.1F, 0.1F};
  return shown_lines<curb_lines_t>(now, line);
}

inline marking_lines_t shown_markings(const ShownMoment& now) {
  marking_line_t paint{};
  paint.type = marking_line_t::SOLID;
  paint.width = 0.12F;
  paint.num_points = 2;
  paint.x = {0, static_cast<float>(now.x) + 1};
  paint.y = {-1, -1};
  paint.z = {0, 0};
  paint.painted = {1, 0};
  return shown_lines<marking_lines_t>(now, paint);
}

/// With a fault at 1 s.
inline service_status_t shown_status(const ShownMoment& now) {
  service_status_t status{};
  status.utime = now.utime;
  status.service = "lidar";
  status.uptime = 50'000 * (now.k + 1);
  status.num_counters = 1;
  status.counter_name = {"packets"};
  status.counter_value = {now.k};
  if (now.k == 20) status.fault = {"no packets"};
  status.num_faults = static_cast<std::int32_t>(status.fault.size());
  return status;
}

/// A drive of `seconds` along x at 1 m/s, of which all products are in the log: a tile of road each 3 m, a curb, a
/// line of paint, points of map and LiDAR, a fault at 1 s.
inline void write_shown_log(const std::string& path, double seconds) {
  LogWriter log(path);
  for (int k = 0; k < static_cast<int>(seconds * 20); ++k) {
    const ShownMoment now{.k = k, .utime = kLogBegin + 50'000 * k, .x = 0.05 * k};
    append(log, "MAP_POSE", shown_pose(now), now.utime + 1000);
    append(log, "LIDAR_POINTS", shown_scan(now), now.utime + 2000);
    append(log, "SEMANTIC_TILE", shown_tile(now), now.utime + 3000);
    append(log, "MAP_POINTS", shown_cloud(now), now.utime + 4000);
    if (k % 20 != 0) continue;
    append(log, "CURBS", shown_curbs(now), now.utime + 5000);
    append(log, "MARKINGS", shown_markings(now), now.utime + 5500);
    append(log, "SERVICE_STATUS", shown_status(now), now.utime + 6000);
  }
}

}  // namespace curbstone::test
