#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/tiles/tile.hpp"
#include "tools/bench/latency/tile_ages.hpp"
#include "tools/bench/latency/timed_vehicle.hpp"

namespace curbstone::bench::latency {

/// Figures of one part of a long drive, as a table row. Costs that grow with the map show from row to row.
struct DrivePart {
  double end = 0;                            ///< s since the drive began
  double driven = 0;                         ///< m since the drive began, by MAP_POSE
  std::size_t tiles = 0;                     ///< tiles of SEMANTIC_TILE, so far
  std::map<std::string, double> cores;       ///< by process: of its node's work in this part
  std::map<std::string, double> longest_ms;  ///< by process: CPU time of the longest work item
  double other_cores = 0;                    ///< of all other threads and of this bench, in this part
  AgeFigures age;                            ///< ms: age of this part's points when their tile is sent
  double memory_mb = 0;                      ///< resident, of all processes together, at the end
};

/// Splits a drive into parts of equal duration. Not thread-safe.
class DriveParts {
 public:
  /// `seconds`: of a part.
  DriveParts(TimedVehicle& vehicle, double seconds);

  void on_message(const TimedMessage& message);
  /// The drive has reached `utime`, us. Returns the part that ended with it, if any.
  std::optional<DrivePart> reach(std::int64_t utime);

 private:
  [[nodiscard]] DrivePart end_part(std::int64_t utime);

  TimedVehicle& vehicle_;
  std::int64_t length_;  // us
  std::int64_t begin_ = 0, part_begin_ = 0;
  TileAges ages_;  // of this part
  std::set<TileKey> tiles_;
  std::vector<double> last_place_;
  double driven_ = 0;
  std::map<std::string, std::int64_t> cpu_before_;  // us
  double all_cpu_before_ = 0;                       // s
};

[[nodiscard]] std::string parts_heading(const DrivePart& first);
[[nodiscard]] std::string part_line(const DrivePart& part);
[[nodiscard]] nlohmann::json to_json(const DrivePart& part);

}  // namespace curbstone::bench::latency
