#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace curbstone::evaluate {

/// Losses, latencies and CPU time of a recorded run.
struct RunFigures {
  int processes = 0;               ///< that sent SERVICE_STATUS; if 0, losses and CPU time are unknown
  std::int64_t lost_packets = 0;   ///< sensor packets and frames lost or refused, from the drivers' counters
  std::int64_t lost_messages = 0;  ///< messages dropped on the bus, from all counters
  /// Messages that were sent but are missing in the recording, by channel, for the counted channels LIDAR_POINTS, IMU
  /// and WHEELS, which are the input of a replay. Empty: none is missing between the first and the last of each.
  std::map<std::string, std::int64_t> lost_by_recorder;
  struct Latency {
    double p50_ms = 0;  ///< from the measurement to the message on the bus
    double p95_ms = 0;
    double p99_ms = 0;
    double max_ms = 0;
    int messages = 0;  ///< number of messages: those sent while the LiDAR was active
  };
  /// Of a tile's newest points; only tiles with new points count. Empty if the log was not recorded live: a replay has
  /// no delays.
  std::optional<Latency> latency;
  /// Latency by channel along the chain of a tile's points: LIDAR_POINTS, ODOMETRY, MAP_POSE, MAP_POINTS, VOTED_POINTS,
  /// if recorded.
  std::map<std::string, Latency> stages;
  /// s from the first LIDAR_POINTS on the bus to the first message of a channel: MAP_POSE, MAP_POINTS, VOTED_POINTS,
  /// SEMANTIC_TILE, if recorded. Empty if the log was not recorded live.
  std::map<std::string, double> first_after_s;
  std::optional<double> set_off_after_s;    ///< likewise, to the first MAP_POSE 5 cm from the first one
  std::map<std::string, double> cores;      ///< CPU seconds per second, by service; empty without SERVICE_STATUS
  std::map<std::string, double> memory_mb;  ///< resident at the end, by service, MB of 10^6 bytes; likewise
  /// The part of it without file pages, which processes share; only for processes that report it.
  std::map<std::string, double> own_memory_mb;
  /// The same a minute after the first LIDAR_POINTS: what the end has more is growth. Empty for a shorter drive.
  std::map<std::string, double> own_memory_after_a_minute_mb;
  std::map<std::string, std::int64_t> losses;  ///< "lidar lost.packets": all that are not zero
  bool log_is_damaged = false;                 ///< parts of the recording could not be read
};

/// Reads an lcm-logger log. Throws std::runtime_error if the file is not one.
[[nodiscard]] RunFigures read_run_log(const std::string& file);

}  // namespace curbstone::evaluate
