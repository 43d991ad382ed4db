#include "tools/replay/replay.hpp"

#include <fmt/format.h>
#include <lcm/eventlog.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <memory>
#include <optional>

#include "common/bus/local_bus.hpp"
#include "common/config/command_line.hpp"
#include "common/config/config.hpp"
#include "common/log/log_reader.hpp"
#include "common/log/log_writer.hpp"
#include "common/log/message_order.hpp"
#include "common/time/clock.hpp"
#include "tools/replay/vehicle.hpp"

namespace curbstone::replay {

namespace {

/// What the drivers say: the rest is made anew from it.
constexpr std::array kSensorChannels = {"LIDAR_POINTS", "IMU", "WHEELS"};

bool is_sensor(const std::string& channel) {
  return std::find(kSensorChannels.begin(), kSensorChannels.end(), channel) != kSensorChannels.end();
}

/// One line on a terminal, redrawn at most ten times a second; silent elsewhere.
class ProgressBar {
 public:
  void show(double fraction, double message_seconds) {
    const std::int64_t now = steady_clock();
    if (isatty(STDERR_FILENO) == 0 || now - last_ < 100'000) return;
    last_ = now;
    constexpr int kWidth = 40;
    const int filled = static_cast<int>(fraction * kWidth);
    fmt::print(stderr, "\rreplay [{:#<{}}{:.<{}}] {:3.0f} %  {:6.1f} s of drive", "", filled, "", kWidth - filled,
               100 * fraction, message_seconds);
  }
  void clear() const {
    if (last_ != 0) fmt::print(stderr, "\r{:80}\r", "");
  }

 private:
  std::int64_t last_ = 0;
};

/// Bytes: a message of one datagram, and its head. What is left behind the last one is more only in a damaged log.
constexpr std::int64_t kLongestRecord = 66'000;
constexpr std::int64_t kLatest = 4'102'444'800'000'000;  // us: the year 2100

struct Arguments {
  std::string log;
  std::string record;
  ReplayOptions vehicle;
};

struct Summary {
  std::int64_t messages = 0;
  std::int64_t refused = 0;  // their times are none
  std::int64_t first_utime = 0;
  std::int64_t last_utime = 0;
  [[nodiscard]] double seconds() const { return static_cast<double>(last_utime - first_utime) * 1e-6; }
};

Summary drive(LogReader& reader, LocalBus& bus, ReplayVehicle& vehicle) {
  Summary summary;
  MessageOrder order;
  ProgressBar progress;
  const auto deliver = [&](const LogEvent& event) {
    const std::int64_t time = message_time(event);
    if (time <= 0 || time > kLatest) {
      ++summary.refused;
      return;
    }
    if (summary.messages++ == 0) summary.first_utime = summary.last_utime = time;
    summary.last_utime = std::max(summary.last_utime, time);
    vehicle.advance(time);
    bus.inject(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    bus.dispatch();
    progress.show(reader.progress(), summary.seconds());
  };
  while (auto event = reader.next()) {
    if (!is_sensor(event->channel)) continue;
    order.push(std::move(*event));
    while (const auto ready = order.pop(false)) deliver(*ready);
  }
  while (const auto ready = order.pop(true)) deliver(*ready);
  vehicle.finish();
  progress.clear();
  return summary;
}

void report(const Summary& summary, const ReplayVehicle& vehicle, double wall_seconds, const std::string& map_file) {
  fmt::print("{:.1f} s of drive in {:.1f} s ({:.1f}x real time), {} messages -> {}\n", summary.seconds(), wall_seconds,
             summary.seconds() / wall_seconds, summary.messages, map_file);
  if (summary.refused > 0) fmt::print("  refused.time {}\n", summary.refused);
  for (const auto& stage : vehicle.stages()) {
    const NodeReport report = stage.node->report();
    for (const auto& [name, value] : report.counters.values()) {
      const bool loss = name.starts_with("dropped.") || name.starts_with("refused.") || name.starts_with("lost.");
      if (loss && value != 0) fmt::print("  {}: {} {}\n", stage.name, name, value);
    }
    for (const std::string& fault : report.faults) fmt::print("  {}: {}\n", stage.name, fault);
  }
}

}  // namespace

int run_replay(int argc, char** argv) {
  Arguments arguments;
  arguments.vehicle.map_file = "map.db";
  CommandLine line(
      "Makes a map from an lcm-logger log with the vehicle's own nodes, in message-time order, as fast as the machine "
      "can",
      "curbstone replay");
  line.argument("log", arguments.log, "Log of lcm-logger with LIDAR_POINTS, IMU and WHEELS").required();
  line.option("--map", arguments.vehicle.map_file, "The map to write; an existing file is replaced").shows_default();
  line.option("--config", arguments.vehicle.config_file, "The vehicle's YAML file");
  line.option("--set", arguments.vehicle.assignments, "SECTION.KEY=VALUE, over the file").one_each();
  line.option("--record", arguments.record, "Write every message, recomputed ones too, to this log");
  if (const auto status = line.read(argc, argv)) return *status;

  LogReader reader(arguments.log);
  try {
    // A replay makes a map; it does not extend one.
    for (const char* suffix : {"", "-wal", "-shm"}) std::remove((arguments.vehicle.map_file + suffix).c_str());
    LocalBus bus;
    std::optional<LogWriter> recorder;
    if (!arguments.record.empty()) {
      recorder.emplace(arguments.record);
      bus.tap([&](const std::string& channel, const void* data, int size, std::int64_t) {
        recorder->write(channel, data, size);
      });
    }
    ReplayVehicle vehicle(arguments.vehicle, bus);
    const std::int64_t start = steady_clock();
    const Summary summary = drive(reader, bus, vehicle);
    if (summary.messages == 0) throw std::runtime_error(arguments.log + ": holds no LIDAR_POINTS, IMU or WHEELS");
    report(summary, vehicle, static_cast<double>(steady_clock() - start) * 1e-6, arguments.vehicle.map_file);
    if (reader.unread() > kLongestRecord) {
      fmt::print(stderr, "curbstone replay: {} is damaged at byte {}: the map ends there, {} bytes were not read\n",
                 arguments.log, reader.read_to(), reader.unread());
      return 1;
    }
    if (reader.truncated()) fmt::print("  {} is cut off in mid-record: the map ends there\n", arguments.log);
  } catch (const ConfigError& error) {
    fmt::print(stderr, "curbstone replay: {}\n", error.what());
    return 2;
  }
  return 0;
}

}  // namespace curbstone::replay
