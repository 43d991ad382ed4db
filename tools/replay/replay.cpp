#include "tools/replay/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <curbstone/service_config_t.hpp>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "common/bus/harmless_counters.hpp"
#include "common/config/command_line.hpp"
#include "common/config/config.hpp"
#include "common/config/version.hpp"
#include "common/log/log_writer.hpp"
#include "common/log/message_order.hpp"
#include "common/time/clock.hpp"
#include "tools/output/inputs.hpp"
#include "tools/output/new_file.hpp"
#include "tools/output/ordered_log.hpp"
#include "tools/output/watched_log.hpp"
#include "tools/recording/recorded_config.hpp"
#include "tools/replay/new_map.hpp"
#include "tools/replay/record_clock.hpp"
#include "tools/replay/vehicle_line.hpp"

namespace curbstone::replay {

namespace {

constexpr std::int64_t kLatest = 4'102'444'800'000'000;  // us: the year 2100

struct Arguments {
  std::vector<std::string> logs;
  std::string record;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  ReplayOptions vehicle;
};

struct Summary {
  std::int64_t messages = 0;
  std::int64_t refused = 0;                        // with invalid times
  std::map<std::string, std::int64_t> other_type;  // by channel
  std::int64_t first_utime = 0;
  std::int64_t last_utime = 0;
  [[nodiscard]] double seconds() const { return static_cast<double>(last_utime - first_utime) * 1e-6; }
};

/// Reports, once per process, differences between the recorded configuration and that of this replay.
class ConfigWatch {
 public:
  explicit ConfigWatch(const VehicleLine& vehicle) : vehicle_(vehicle) {}

  void on(const service_config_t& recorded) {
    if (!seen_.insert(recorded.service + recorded.yaml + recorded.version).second || seen_.size() > kMaxConfigs) return;
    for (const auto& stage : vehicle_.stages()) {
      if (stage.name != recorded.section) continue;
      for (const std::string& difference : recording::config_differences(stage.config, recorded.yaml))
        print_line(difference);
      if (recorded.version != version())
        print_line(
            fmt::format("{} was recorded by version {}, this is {}", recorded.service, recorded.version, version()));
    }
  }
  void say_all() const {
    for (const std::string& line : lines_) fmt::print(stderr, "curbstone replay: {}\n", line);
  }

 private:
  static constexpr std::size_t kMaxConfigs = 1000;  // bound, because a log may contain anything

  void print_line(const std::string& line) {
    if (std::find(lines_.begin(), lines_.end(), line) == lines_.end()) lines_.push_back(line);
  }

  const VehicleLine& vehicle_;
  std::set<std::string> seen_;
  std::vector<std::string> lines_;
};

/// Writes the configurations to the record, as a recorder does, so that a log of --record states what it was made with.
void note_configs(VehicleLine& vehicle, std::int64_t utime) {
  for (const auto& stage : vehicle.stages()) {
    const service_config_t message{utime, stage.name, stage.name, "replay", version(), stage.config};
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, message.getEncodedSize());
    vehicle.note("CONFIG", std::move(bytes));
  }
}

Summary drive(output::WatchedLog& log, VehicleLine& vehicle) {
  Summary summary;
  MessageOrder order;
  ConfigWatch configs(vehicle);
  const auto deliver = [&](LogEvent event) {
    const std::int64_t time = message_time(event);
    if (time <= 0 || time > kLatest) {
      ++summary.refused;
      return;
    }
    if (summary.messages++ == 0) {
      summary.first_utime = summary.last_utime = time;
      note_configs(vehicle, time);
    }
    summary.last_utime = std::max(summary.last_utime, time);
    vehicle.deliver(order.time(), std::move(event.channel), std::move(event.bytes));
  };
  while (auto event = log.next()) {
    if (const auto config = recording::config_in(*event)) configs.on(*config);
    if (!output::is_of_a_driver(event->channel)) continue;
    if (output::has_other_type(*event)) {
      ++summary.other_type[event->channel];
      continue;
    }
    order.push(std::move(*event));
    while (auto ready = order.pop()) deliver(std::move(*ready));
  }
  while (auto ready = order.pop_rest()) deliver(std::move(*ready));
  vehicle.finish();
  configs.say_all();
  return summary;
}

/// Whether the file has the complete map; the disk may have been full.
bool is_map_whole(const VehicleLine& vehicle) {
  for (const auto& stage : vehicle.stages()) {
    const Counters counters = stage.node->report().counters;
    for (const char* name : {"store.failing", "dropped.unstored_tiles", "dropped.unstored_poses"})
      if (counters[name] != 0) return false;
  }
  return true;
}

std::string config_source(const ReplayOptions& options) {
  return recording::source_of_configuration({"ekf", "mapper", "tensor_voting", "semantic_map"}, options.config_file,
                                            options.recorded, options.assignments);
}

void report(const Summary& summary, const VehicleLine& vehicle, double wall_seconds, const NewMap& map,
            const std::string& configuration) {
  fmt::print("{:.1f} s of drive in {:.1f} s ({:.1f}x real time), {} messages -> {}\n", summary.seconds(), wall_seconds,
             summary.seconds() / wall_seconds, summary.messages, map.with_final_names(map.part()));
  fmt::print("  configuration: {}\n", configuration);
  if (summary.refused > 0) fmt::print("  refused.time {}\n", summary.refused);
  for (const auto& [channel, count] : summary.other_type)
    fmt::print("  refused.type {}: messages on {} that have another type than the drivers'\n", count, channel);
  const Counters bus = vehicle.bus_counters();
  for (const auto& [name, value] : bus.values()) fmt::print("  {} {}\n", name, value);
  for (const auto& stage : vehicle.stages()) {
    const NodeReport report = stage.node->report();
    for (const auto& [name, value] : report.counters.values()) {
      const bool loss = name.starts_with("dropped.") || name.starts_with("refused.") || name.starts_with("lost.");
      if (loss && !is_harmless(name) && value != 0) fmt::print("  {}: {} {}\n", stage.name, name, value);
    }
    for (const std::string& fault : report.faults) fmt::print("  {}: {}\n", stage.name, map.with_final_names(fault));
  }
}

/// Returns whether the logs are damaged.
bool make_map(const Arguments& arguments, output::WatchedLog& log, const NewMap& map) {
  std::optional<output::NewFile> record;
  std::optional<LogWriter> recorder;
  RecordClock clock;
  StageLine::Options options{.threads = arguments.threads > 1, .everything = {}};
  if (!arguments.record.empty()) {
    record.emplace(arguments.record, true);
    recorder.emplace(record->part());
    options.everything = [&](const LineItem& message) {
      recorder->write(message.channel, message.bytes.data(), static_cast<int>(message.bytes.size()),
                      clock.time_of(message));
    };
  }
  VehicleLine vehicle(arguments.vehicle, options);
  const std::int64_t start = steady_clock();
  const Summary summary = drive(log, vehicle);
  if (summary.messages == 0)
    throw std::runtime_error(fmt::format("{}: holds no LIDAR_POINTS, IMU or WHEELS{}", arguments.logs[0],
                                         summary.other_type.empty() ? "" : " of a type that this version knows"));
  if (recorder) recorder->flush();
  report(summary, vehicle, static_cast<double>(steady_clock() - start) * 1e-6, map, config_source(arguments.vehicle));
  if (!is_map_whole(vehicle))
    throw std::runtime_error(map.with_final_names(map.part()) + ": the map is not written whole: is the disk full?");
  if (record) record->commit();
  return log.damaged();
}

}  // namespace

int run_replay(int argc, char** argv) {
  Arguments arguments;
  arguments.vehicle.map_file = "map.db";
  CommandLine line(
      "Makes a map from an lcm-logger log with the vehicle's own nodes, in message-time order, as fast as the machine "
      "can",
      "curbstone replay");
  line.option("log", arguments.logs, "Logs of lcm-logger with LIDAR_POINTS, IMU and WHEELS, or a session's folder")
      .required();
  line.option("--map", arguments.vehicle.map_file, "The map to write; an existing map is replaced").shows_default();
  line.option("--config", arguments.vehicle.config_file,
              "The vehicle's YAML file, instead of what the log was recorded with");
  line.option("--set", arguments.vehicle.assignments, "SECTION.KEY=VALUE, over the file").one_each();
  line.option("--record", arguments.record, "Write every message, recomputed ones too, to this log");
  line.option("--threads", arguments.threads,
              "1: the stages one after the other, in one thread; else side by side. The map is the same")
      .within(1, 1000);
  if (const auto status = line.read(argc, argv)) return *status;

  output::WatchedLog log(arguments.logs, "replay");
  LogFiles head(arguments.logs);
  arguments.vehicle.recorded = recording::recorded_config(head);
  output::refuse_to_overwrite(head.names(), arguments.record);
  check_configuration(arguments.vehicle);  // before anything is written
  NewMap map(arguments.vehicle.map_file);
  arguments.vehicle.map_file = map.part();
  arguments.vehicle.keep_earlier_drives = true;
  const bool damaged = make_map(arguments, log, map);
  for (const std::string& earlier : map.commit()) fmt::print("  an earlier drive of this log -> {}\n", earlier);
  return damaged ? 1 : 0;
}

}  // namespace curbstone::replay
