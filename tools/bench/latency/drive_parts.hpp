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

/// A long drive part by part: what costs more the larger the map is, shows from row to row.
struct DrivePart {
  double end = 0;                            ///< s since the drive began
  double driven = 0;                         ///< m since then, by MAP_POSE
  std::size_t tiles = 0;                     ///< of SEMANTIC_TILE, so far
  std::map<std::string, double> cores;       ///< by process: of its node's work in this part
  std::map<std::string, double> longest_ms;  ///< by process: CPU time of the longest piece of that work
  double other_cores = 0;                    ///< of all other threads and of this bench, in this part
  AgeFigures age;                            ///< ms: points of this part, when their tile is out
  double memory_mb = 0;                      ///< resident, of all together, at the end
};

/// Cuts a drive into parts of equal time. Not for several threads.
class DriveParts {
 public:
  /// `seconds`: of a part.
  DriveParts(TimedVehicle& vehicle, double seconds);

  void hear(const TimedMessage& message);
  /// The drive has come to `utime`, us. The part that ended with it, if one did.
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
