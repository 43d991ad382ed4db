#include "tools/bench/latency/latency_bench.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "common/config/assignments.hpp"
#include "common/config/command_line.hpp"
#include "common/config/config.hpp"
#include "tools/bench/latency/drive_parts.hpp"
#include "tools/bench/latency/tile_ages.hpp"
#include "tools/bench/latency/timed_vehicle.hpp"
#include "tools/output/ordered_log.hpp"
#include "tools/output/text_file.hpp"
#include "tools/output/watched_log.hpp"

namespace curbstone::bench::latency {

namespace {

constexpr std::array<std::string_view, 4> kSections = {"ekf", "mapper", "tensor_voting", "semantic_map"};

struct LatencyBenchOptions {
  std::string log, json;
  double every = 0;  // s per row; 0: one row for the whole drive
  TimedVehicleOptions vehicle;
};

void print_ages(nlohmann::json& json, const std::string& name, const AgeFigures& f) {
  fmt::print("  {:<34} {:>8} {:>8.0f} {:>8.0f} {:>8.0f}", name, f.count, f.p50, f.p95, f.max);
  json["ms"][name] = {{"count", f.count}, {"p50", f.p50}, {"p95", f.p95}, {"max", f.max}};
}

void print_traffic(nlohmann::json& json, const std::string& channel, double per_s, double megabytes_per_s) {
  fmt::print(" {:>8.0f} {:>6.2f}", per_s, megabytes_per_s);
  json["sent"][channel] = {{"per_s", per_s}, {"mb_per_s", megabytes_per_s}};
}

nlohmann::json report(const TimedVehicle& vehicle, const TileAges& ages, double seconds) {
  nlohmann::json json{{"seconds", seconds}};
  fmt::print("{:.1f} s of drive, on a clock of CPU time\n\n", seconds);
  fmt::print("  {:<34} {:>8} {:>8} {:>8} {:>8} {:>8} {:>6}\n", "age of the newest points, ms", "counted", "p50", "p95",
             "max", "sent/s", "MB/s");
  for (const char* channel : {"MAP_POSE", "MAP_POINTS", "VOTED_POINTS", "SEMANTIC_TILE"}) {
    print_ages(json, channel, ages.age(channel));
    print_traffic(json, channel, static_cast<double>(ages.sent(channel)) / seconds, ages.megabytes(channel) / seconds);
    fmt::print("\n");
  }
  print_ages(json, "all points, to SEMANTIC_TILE", ages.news());
  fmt::print("\n");
  print_ages(json, "all points, to its curbs", ages.curb_news());
  fmt::print("\n");
  print_ages(json, "all points, to CURBS", ages.line_news());
  fmt::print("\n\n  CPU, in cores:");
  for (const auto& [name, process] : vehicle.processes()) {
    const double cores = static_cast<double>(process->cpu_us()) * 1e-6 / seconds;
    fmt::print("  {} {:.3f}", name, cores);
    json["cores"][name] = cores;
  }
  fmt::print("\n");
  for (const auto& [name, process] : vehicle.processes()) {
    const NodeReport said = process->node().report();
    for (const auto& [counter, value] : said.counters.values()) json["counters"][name][counter] = value;
  }
  return json;
}

nlohmann::json measure(const LatencyBenchOptions& options) {
  output::WatchedLog reader(options.log, "bench latency");
  TileAges ages;
  std::optional<DriveParts> parts;
  TimedVehicle vehicle(options.vehicle, [&](const TimedMessage& message) {
    parts ? parts->on_message(message) : ages.on_message(message);
  });
  if (options.every > 0) parts.emplace(vehicle, options.every);
  nlohmann::json rows = nlohmann::json::array();
  std::int64_t first = 0;
  std::int64_t last = 0;
  while (const auto event = reader.next()) {
    if (!output::is_of_a_driver(event->channel)) continue;
    if (first == 0) first = event->log_utime;
    last = std::max(last, event->log_utime);
    vehicle.sense(*event);
    if (const auto part = parts ? parts->reach(last) : std::nullopt) {
      fmt::print("{}{}", rows.empty() ? parts_heading(*part) : "", part_line(*part));
      std::fflush(stdout);
      rows.push_back(to_json(*part));
    }
  }
  if (first == last) throw std::runtime_error(options.log + ": holds no LIDAR_POINTS, IMU or WHEELS");
  if (parts) return {{"parts", rows}};
  return report(vehicle, ages, static_cast<double>(last - first) * 1e-6);
}

}  // namespace

int run_bench_latency(int argc, char** argv) {
  LatencyBenchOptions options;
  CommandLine line(
      "From the last packet of a revolution to the changed tiles on the bus, stage by stage. The services run as "
      "processes on a clock that goes on by the CPU time of their work, so that a busy machine gives the same figures",
      "curbstone bench latency");
  line.argument("log", options.log, "Log with LIDAR_POINTS, IMU and WHEELS").required();
  line.option("--config", options.vehicle.config_file, "The vehicle's YAML file");
  line.option("--set", options.vehicle.assignments, "SECTION.KEY=VALUE, over the file").one_each();
  line.option("--map", options.vehicle.map_file, "Keep the map in this file (default: in memory only)");
  line.option("--cores", options.vehicle.cores, "That the services share").within(1, 64).shows_default();
  line.option("--every", options.every, "s: a row for each part of the drive instead, to see what grows with the map")
      .within(1, 36000);
  line.option("--json", options.json, "Write the figures to this file too");
  if (const auto status = line.read(argc, argv)) return *status;
  options.vehicle.assignments = assignments_for(kSections, options.vehicle.assignments);
  const nlohmann::json json = measure(options);
  if (!options.json.empty()) output::write_text(options.json, json.dump(2) + '\n');
  return 0;
}

}  // namespace curbstone::bench::latency
