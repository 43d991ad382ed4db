#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "common/bus/decode.hpp"
#include "common/config/command_line.hpp"
#include "common/config/vehicle.hpp"
#include "tools/log_tool/commands.hpp"
#include "tools/log_tool/scans.hpp"
#include "tools/output/inputs.hpp"
#include "tools/output/new_file.hpp"
#include "tools/output/watched_log.hpp"
#include "tools/recording/recorded_config.hpp"

namespace curbstone::log_tool {

namespace {

struct PcdOptions {
  std::vector<std::string> logs;
  std::string channel = "LIDAR_POINTS";
  std::string out;
  bool merged = false;
  std::vector<double> lidar;  // empty: as recorded
  int first = 0;
  int count = std::numeric_limits<int>::max();
  bool force = false;
};

template <class Message>
bool decode_event(const LogEvent& event, Message& message) {
  return decode(event.bytes.data(), static_cast<int>(event.bytes.size()), message);
}

/// Calls `on_scan` for the wanted scans of the log, a LogFiles or a WatchedLog. Returns how many packets were left out.
template <class Log>
std::int64_t for_each_scan(Log& log, const PcdOptions& options, const ScanCollector::OnScan& on_scan) {
  int number = 0;
  ScanCollector collector([&](const LoggedScan& scan) {
    const int n = number++;
    if (n >= options.first && n - options.first < options.count) on_scan(scan);
  });
  lidar_points_t message;
  while (const auto event = log.next()) {
    if (event->channel == options.channel && decode_event(*event, message)) collector.take(message);
  }
  collector.finish();
  if (number <= options.first)
    throw std::runtime_error(fmt::format("{} has {} scans of lidar_points_t", options.channel, number));
  return collector.left_out();
}

void say_left_out(std::int64_t packets) {
  if (packets > 0)
    fmt::print(stderr, "curbstone log pcd: {} packets came twice, or after their revolution, and are left out\n",
               packets);
}

LoggedPath path_in(const PcdOptions& options) {
  LoggedPath path;
  LogFiles files(options.logs);
  map_pose_t pose;
  map_trajectory_t corrected;
  while (const auto event = files.next()) {
    if (event->channel == "MAP_POSE" && decode_event(*event, pose)) path.take(pose);
    if (event->channel == "MAP_TRAJECTORY" && decode_event(*event, corrected)) path.take(corrected);
  }
  if (path.empty())
    throw std::runtime_error(
        "no MAP_POSE: 'curbstone replay LOG --record NEW.lcmlog' makes a log that has the poses, too");
  return path;
}

bool write_each(const PcdOptions& options) {
  std::int64_t files = 0;
  output::WatchedLog log(options.logs, "log pcd");
  const std::int64_t left_out = for_each_scan(log, options, [&](const LoggedScan& scan) {
    if (files == 0) std::filesystem::create_directories(options.out);
    const auto name = std::filesystem::path(options.out) / fmt::format("scan-{}.pcd", scan.utime);
    output::NewFile file(name, options.force);
    ScanPcdFile pcd(file.part(), scan.points.size());
    pcd.add(scan.points);
    pcd.finish();
    file.commit();
    ++files;
  });
  say_left_out(left_out);
  fmt::print("{}: {} scans\n", options.out, files);
  return log.damaged();
}

/// Where the mapper that published MAP_POSE had the LiDAR.
Pose lidar_in(const PcdOptions& options) {
  VehicleConfig vehicle;
  if (options.lidar.empty()) {
    LogFiles head(options.logs);
    vehicle = recording::recorded_config(head).vehicle();
  } else {
    vehicle.lidar = options.lidar;
  }
  fmt::print("T_base_lidar: [{}]\n", fmt::join(vehicle.lidar, ", "));
  return vehicle.T_base_lidar();
}

/// us, of a point of the scan.
std::int64_t time_of(const ScanPoint& point, const LoggedScan& scan) {
  return scan.utime + static_cast<std::int64_t>(point.t * 1e6F);
}

/// How many points of the log there are, and how many of them have a pose.
struct PointCount {
  std::int64_t all = 0;
  std::int64_t placed = 0;
};

PointCount count_points(const PcdOptions& options, const LoggedPath& path) {
  PointCount count;
  LogFiles files(options.logs);
  (void)for_each_scan(files, options, [&](const LoggedScan& scan) {
    count.all += std::ssize(scan.points);
    count.placed += std::count_if(scan.points.begin(), scan.points.end(),
                                  [&](const ScanPoint& point) { return path.reaches(time_of(point, scan)); });
  });
  return count;
}

/// The points of an hour fill the memory of any host, so they are counted first, for the header, and then written scan
/// by scan.
bool write_merged(const PcdOptions& options) {
  const LoggedPath path = path_in(options);
  const Pose T_base_lidar = lidar_in(options);
  output::NewFile file(options.out, options.force);
  const PointCount count = count_points(options, path);
  ScanPcdFile pcd(file.part(), static_cast<std::size_t>(count.placed));
  output::WatchedLog log(options.logs, "log pcd");
  std::vector<ScanPoint> placed;
  const std::int64_t left_out = for_each_scan(log, options, [&](const LoggedScan& scan) {
    placed.clear();
    for (ScanPoint point : scan.points) {
      const auto T_map_base = path.at(time_of(point, scan));
      if (!T_map_base) continue;
      const Eigen::Vector3f in_map =
          (*T_map_base * T_base_lidar * Eigen::Vector3f(point.x, point.y, point.z).cast<double>()).cast<float>();
      point.x = in_map.x();
      point.y = in_map.y();
      point.z = in_map.z();
      placed.push_back(point);
    }
    pcd.add(placed);
  });
  pcd.finish();
  file.commit();
  say_left_out(left_out);
  fmt::print("{}: {} points in map, {} without a pose left out\n", options.out, count.placed, count.all - count.placed);
  return log.damaged();
}

}  // namespace

int run_pcd(int argc, char** argv) {
  PcdOptions options;
  CommandLine line("The LiDAR scans of a log as PCD files: x y z intensity ring t", "curbstone log pcd");
  line.option("log", options.logs, "LCM logs, or the folder of a session").required();
  line.option("--out", options.out, "A folder, in which each scan becomes scan-<utime>.pcd; with --merged, the file")
      .required();
  line.flag(
      "--merged", options.merged,
      "All in one file, in the last map, each point where MAP_POSE and MAP_TRAJECTORY have the vehicle at its time");
  line.option(
          "--lidar", options.lidar,
          "--merged: T_base_lidar: x y z in m, roll pitch yaw in rad; default: vehicle.lidar of the drive, as recorded")
      .comma_separated();
  line.option("--channel", options.channel, "Whose points").shows_default();
  line.option("--first", options.first, "The first scan that is wanted, from 0").within(0, 1'000'000'000);
  line.option("--count", options.count, "How many; default: all").within(1, 1'000'000'000);
  line.flag("--force", options.force, "Replace files that are there");
  if (const auto status = line.read(argc, argv)) return *status;
  if (options.merged) output::refuse_to_overwrite(LogFiles(options.logs).names(), options.out);
  if (line.given("--lidar") && options.lidar.size() != 6) throw std::runtime_error("--lidar: expected six numbers");
  return (options.merged ? write_merged(options) : write_each(options)) ? 1 : 0;
}

}  // namespace curbstone::log_tool
