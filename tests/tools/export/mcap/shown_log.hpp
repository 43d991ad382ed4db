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

/// A drive of `seconds` along x at 1 m/s, of which all products are in the log: a tile of road each 3 m, a curb, a
/// line of paint, points of map and LiDAR, a fault at 1 s.
inline void write_shown_log(const std::string& path, double seconds) {
  LogWriter log(path);
  const std::int32_t epoch = kLogBegin / 1'000'000;
  int points = 0;
  for (int k = 0; k < static_cast<int>(seconds * 20); ++k) {
    const std::int64_t utime = kLogBegin + 50'000 * k;
    const double x = 0.05 * k;
    map_pose_t pose{};
    pose.utime = utime;
    pose.epoch = epoch;
    pose.map_base_position[0] = x;
    pose.map_base_orientation[0] = pose.map_odom_orientation[0] = 1;
    append(log, "MAP_POSE", pose, utime + 1000);
    lidar_points_t scan{};
    scan.utime = utime;
    scan.revolution = k;
    scan.num_points = 2;
    scan.x = {5, 6};
    scan.y = scan.z = scan.time_offset = {0, 1};
    scan.intensity = scan.ring = {10, 11};
    append(log, "LIDAR_POINTS", scan, utime + 2000);
    semantic_tile_t tile{};
    tile.utime = utime;
    tile.epoch = epoch;
    tile.tile_x = static_cast<std::int32_t>(x / 3);
    tile.revision = k + 1;
    for (auto& cell : tile.cell_class) cell = semantic_tile_t::ROAD;
    append(log, "SEMANTIC_TILE", tile, utime + 3000);
    map_points_t cloud{};
    cloud.utime = utime;
    cloud.epoch = epoch;
    cloud.first = points;
    cloud.num_points = 3;
    cloud.x = {1, 2, 3};
    cloud.y = cloud.z = {static_cast<std::int16_t>(k), 0, 0};
    cloud.intensity = {7, 8, 9};
    points += 3;
    append(log, "MAP_POINTS", cloud, utime + 4000);
    if (k % 20 != 0) continue;
    curb_line_t line{};
    line.num_points = 2;
    line.x = {0, static_cast<float>(x) + 1};
    line.y = {2, 2};
    line.z = line.high_side_x = line.high_side_y = {0, 0};
    line.height = {0.1F, 0.1F};
    curb_lines_t curbs{};
    curbs.utime = utime;
    curbs.epoch = epoch;
    curbs.box_min[0] = curbs.box_min[1] = -100;
    curbs.box_max[0] = curbs.box_max[1] = 100;
    curbs.num_lines = 1;
    curbs.lines = {line};
    append(log, "CURBS", curbs, utime + 5000);
    marking_line_t paint{};
    paint.type = marking_line_t::SOLID;
    paint.width = 0.12F;
    paint.num_points = 2;
    paint.x = line.x;
    paint.y = {-1, -1};
    paint.z = {0, 0};
    paint.painted = {1, 0};
    marking_lines_t markings{};
    markings.utime = utime;
    markings.epoch = epoch;
    markings.box_min[0] = markings.box_min[1] = -100;
    markings.box_max[0] = markings.box_max[1] = 100;
    markings.num_lines = 1;
    markings.lines = {paint};
    append(log, "MARKINGS", markings, utime + 5500);
    service_status_t status{};
    status.utime = utime;
    status.service = "lidar";
    status.uptime = 50'000 * (k + 1);
    status.num_counters = 1;
    status.counter_name = {"packets"};
    status.counter_value = {k};
    if (k == 20) status.fault = {"no packets"};
    status.num_faults = static_cast<std::int32_t>(status.fault.size());
    append(log, "SERVICE_STATUS", status, utime + 6000);
  }
}

}  // namespace curbstone::test
