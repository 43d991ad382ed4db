// Development tool, no test: a log of lcm-logger (through ekf and mapper) or a capture of an RS-LiDAR-16 (through
// lidar and mapper); prints errors and times, draws the dense map from above.
//   bench_drive LOG|PCAP [truth=poses.csv] [png=FILE] [odometry=0] [KEY=VALUE...]
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <fstream>
#include <map>

#include "common/bus/local_bus.hpp"
#include "common/log/log_reader.hpp"
#include "common/log/message_order.hpp"
#include "drivers/lidar/packet_feed.hpp"
#include "services/ekf/ekf_node.hpp"
#include "services/mapper/mapper_node.hpp"
#include "tools/evaluate/truth/trajectory.hpp"
#include "tools/simulate/truth/gray_image.hpp"

namespace {

using namespace curbstone;

struct MapPoint {
  double x, y, z;
};

struct Result {
  std::vector<map_pose_t> poses;
  evaluate::truth::Trajectory odometry;
  std::vector<MapPoint> points;
  std::vector<double> ms;
  std::size_t largest = 0;
};

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

evaluate::truth::Trajectory read_truth(const std::string& file) {
  evaluate::truth::Trajectory out;
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    std::int64_t utime = 0;
    double p[3], q[4];
    fields >> utime >> p[0] >> p[1] >> p[2] >> q[0] >> q[1] >> q[2] >> q[3];
    if (fields) out.push_back({utime, pose_from_arrays(p, q)});
  }
  return out;
}

void draw(const std::string& file, const Result& result) {
  double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
  for (const MapPoint& p : result.points) {
    low[0] = std::min(low[0], p.x), high[0] = std::max(high[0], p.x);
    low[1] = std::min(low[1], p.y), high[1] = std::max(high[1], p.y);
  }
  const double size = std::max(0.02, std::max(high[0] - low[0], high[1] - low[1]) / 1600);
  simulate::truth::GrayImage image(static_cast<int>((high[0] - low[0]) / size) + 1,
                                   static_cast<int>((high[1] - low[1]) / size) + 1);
  std::map<std::pair<int, int>, double> ground;  // 1 m cells
  const auto cell = [](const MapPoint& p) {
    return std::pair(static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)));
  };
  for (const MapPoint& p : result.points) {
    const auto [it, fresh] = ground.try_emplace(cell(p), p.z);
    if (!fresh) it->second = std::min(it->second, p.z);
  }
  for (const MapPoint& p : result.points) {
    const double height = p.z - ground[cell(p)];
    auto& pixel = image.at(static_cast<int>((p.x - low[0]) / size), static_cast<int>((high[1] - p.y) / size));
    pixel = std::max(pixel, static_cast<std::uint8_t>(std::clamp(60 + 195 * height / 0.5, 60.0, 255.0)));
  }
  simulate::truth::write_png(file, image);
}

void report(const std::string& name, const evaluate::truth::Trajectory& track,
            const evaluate::truth::Trajectory& truth) {
  const evaluate::truth::TrajectoryErrors e =
      evaluate::truth::trajectory_errors(evaluate::truth::pair_up(truth, track));
  fmt::print("{}: t_rel {:.3f} %  r_rel {:.4f} deg/m  ATE {:.3f} m  end {:.3f} %  of {:.1f} m\n", name, e.rpe_percent,
             e.rpe_deg_per_m, e.ate_m, e.end_percent, e.distance_m);
}

void feed_log(const std::string& file, bool with_odometry, LocalBus& bus, mapper::MapperNode& node, Result& result) {
  ekf::EkfNode ekf(ekf::base::EkfConfig{}, bus);
  if (with_odometry) ekf.connect(bus);
  LogReader reader(file);
  MessageOrder order;
  std::int64_t ticked = 0;
  const auto handle = [&](const LogEvent& event) {
    const std::int64_t now = message_time(event);
    const double begin = cpu_ms();
    bus.inject(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    const std::size_t before = result.poses.size();
    bus.dispatch();
    if (now - ticked > 20'000) ekf.tick(now), node.tick(now), bus.dispatch(), ticked = now;
    if (result.poses.size() > before) result.ms.push_back(cpu_ms() - begin);
  };
  const double begin = cpu_ms();
  while (const auto event = reader.next()) {
    order.push(*event);
    while (const auto next = order.pop()) handle(*next);
  }
  while (const auto next = order.pop_rest()) handle(*next);
  ekf.finish();
  bus.dispatch();
  fmt::print("CPU of it all: {:.1f} s\n", (cpu_ms() - begin) * 1e-3);
}

struct Options {
  std::string file, truth, png;
  bool with_odometry = true;
  ConfigOf<mapper::config::MapperConfig> config;
};

Options read_options(int argc, char** argv) {
  Options options;
  options.file = argv[1];
  for (int i = 2; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.starts_with("truth="))
      options.truth = argument.substr(6);
    else if (argument.starts_with("png="))
      options.png = argument.substr(4);
    else if (argument == "odometry=0")
      options.with_odometry = false;
    else
      set_config_value(argument, options.config);
  }
  return options;
}

void collect(LocalBus& bus, Result& result) {
  bus.subscribe<map_pose_t>("MAP_POSE", [&](const map_pose_t& m) { result.poses.push_back(m); });
  bus.subscribe<odometry_t>("ODOMETRY", [&](const odometry_t& m) {
    if (m.flags & odometry_t::INITIALISED)
      result.odometry.push_back({m.utime, pose_from_arrays(m.position, m.orientation)});
  });
  bus.subscribe<map_points_t>("MAP_POINTS", [&](const map_points_t& m) {
    result.largest = std::max(result.largest, static_cast<std::size_t>(m.getEncodedSize()));
  });
}

void feed_capture(const std::string& file, LocalBus& bus) {
  lidar::LidarConfig lidar;
  lidar.pcap = file;
  lidar::LidarNode driver(lidar, bus);
  fmt::print("{} packets\n", lidar::feed_whole_capture(lidar, driver));
  bus.dispatch();
}

void take_points(const mapper::MapperNode& node, Result& result) {
  for (const TileKey& key : node.mapper().dense().keys()) {
    const mapper::dense_map::DenseTile& tile = *node.mapper().dense().tile(key);
    for (const TilePoint& p : tile.read()->points()) {
      result.points.push_back({key.x * kTileSize + p.x * kPositionStep, key.y * kTileSize + p.y * kPositionStep,
                               tile.z_origin() + p.z * kPositionStep});
    }
  }
}

evaluate::truth::Trajectory print_poses(const std::vector<map_pose_t>& poses) {
  double residual = 0, inliers = 0, iterations = 0;
  int registered = 0, degenerate = 0, stationary = 0, without = 0;
  evaluate::truth::Trajectory track;
  for (const map_pose_t& m : poses) {
    track.push_back({m.utime, pose_from_arrays(m.map_base_position, m.map_base_orientation)});
    residual += static_cast<double>(m.residual);
    inliers += static_cast<double>(m.inlier_ratio);
    iterations += m.iterations;
    registered += (m.flags & map_pose_t::REGISTERED) != 0;
    stationary += (m.flags & map_pose_t::STATIONARY) != 0;
    without += (m.flags & map_pose_t::NO_ODOMETRY) != 0;
    degenerate += m.degenerate != 0;
  }
  const auto n = static_cast<double>(poses.size());
  fmt::print(
      "{} poses: {} registered, {} stationary, {} without odometry, {} degenerate; residual {:.3f} inliers {:.2f} "
      "iterations {:.1f}\n",
      poses.size(), registered, stationary, without, degenerate, residual / n, inliers / n, iterations / n);
  return track;
}

void print_times(std::vector<double> ms) {
  if (ms.empty()) return;
  std::sort(ms.begin(), ms.end());
  fmt::print("ms CPU a revolution (with all its messages): median {:.1f} p95 {:.1f} max {:.1f}\n", ms[ms.size() / 2],
             ms[ms.size() * 95 / 100], ms.back());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const Options options = read_options(argc, argv);
  LocalBus bus;
  mapper::MapperNode node(options.config.value, bus);
  node.connect(bus);
  Result result;
  collect(bus, result);
  if (options.file.ends_with(".pcap"))
    feed_capture(options.file, bus);
  else
    feed_log(options.file, options.with_odometry, bus, node, result);
  node.finish();
  bus.dispatch();
  take_points(node, result);

  const evaluate::truth::Trajectory track = print_poses(result.poses);
  print_times(result.ms);
  fmt::print("{} points, largest message {} bytes\n", result.points.size(), result.largest);
  const NodeReport summary = node.report();
  for (const auto& [name, value] : summary.counters.values()) fmt::print("{} {}  ", name, value);
  fmt::print("\n");
  if (!options.truth.empty()) {
    const auto truth = read_truth(options.truth);
    report("mapper", track, truth);
    if (options.with_odometry) report("ekf   ", result.odometry, truth);
  }
  if (!options.png.empty()) draw(options.png, result);
  return 0;
}
