#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace curbstone::evaluate {

/// Losses, latencies and CPU time of a recorded run.
struct RunFigures {
  int processes = 0;               ///< that sent SERVICE_STATUS; without any, nothing is known of losses and CPU
  std::int64_t lost_packets = 0;   ///< sensor packets and frames lost or refused, from the drivers' counters
  std::int64_t lost_messages = 0;  ///< messages dropped on the bus, from everybody's counters
  /// Messages that were sent and are not in the recording, by channel, where there is a count: LIDAR_POINTS, IMU,
  /// WHEELS, all that a replay starts from. Empty: nothing is missing between the first of each and the last.
  std::map<std::string, std::int64_t> lost_by_recorder;
  struct Latency {
    double p50_ms = 0;  ///< from the measurement to the message on the bus
    double p95_ms = 0;
    int messages = 0;  ///< that it is taken from: those sent while the LiDAR spoke
  };
  /// Of a tile's newest points; only of tiles with something new in them. Nothing where the log was not recorded live:
  /// a replay has no delays.
  std::optional<Latency> latency;
  /// What a tile's points wait for on their way: LIDAR_POINTS, ODOMETRY, MAP_POSE, MAP_POINTS, VOTED_POINTS where
  /// recorded.
  std::map<std::string, Latency> stages;
  /// s from the first LIDAR_POINTS on the bus to the first message of a channel: MAP_POSE, MAP_POINTS, VOTED_POINTS,
  /// SEMANTIC_TILE where recorded. Empty where the log was not recorded live.
  std::map<std::string, double> first_after_s;
  std::optional<double> set_off_after_s;    ///< likewise, to the first MAP_POSE that is 5 cm from the first
  std::map<std::string, double> cores;      ///< CPU seconds a second, by service; empty without SERVICE_STATUS
  std::map<std::string, double> memory_mb;  ///< resident at the end, by service, MB of 10^6 bytes; likewise
  /// Of it without pages of files, which processes share; without what has no such figure.
  std::map<std::string, double> own_memory_mb;
  std::map<std::string, std::int64_t> losses;  ///< "lidar lost.packets": whatever is not zero
  bool log_is_damaged = false;                 ///< parts of the recording could not be read
};

/// Reads an lcm-logger log. Throws std::runtime_error if it is none.
[[nodiscard]] RunFigures read_run_log(const std::string& file);

}  // namespace curbstone::evaluate
