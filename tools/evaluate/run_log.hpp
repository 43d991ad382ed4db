#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace curbstone {

/// What the recording of a run says of how it ran.
struct RunFigures {
  std::int64_t lost_packets = 0;      ///< sensor packets and frames lost or refused, from the drivers' counters
  std::int64_t lost_messages = 0;     ///< messages dropped on the bus, from everybody's counters
  std::int64_t lost_by_recorder = 0;  ///< LIDAR_POINTS that were sent and are not in the recording
  double latency_p50_ms = 0;          ///< from the measurement of the newest points in a tile to the tile on the bus
  double latency_p95_ms = 0;
  int tiles = 0;                        ///< SEMANTIC_TILEs the latency is taken from: those sent while the LiDAR spoke
  std::map<std::string, double> cores;  ///< CPU seconds a second, by service
  std::map<std::string, std::int64_t> losses;  ///< "rslidar lost.packets": whatever is not zero
};

/// Reads an lcm-logger log. Throws std::runtime_error if it is none.
[[nodiscard]] RunFigures read_run_log(const std::string& file);

}  // namespace curbstone
