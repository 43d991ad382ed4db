#pragma once

#include <cstdint>
#include <curbstone/semantic_tile_t.hpp>
#include <map>
#include <string>
#include <vector>

namespace curbstone::bench::viewer {

/// What one page was sent.
struct PageTraffic {
  std::int64_t bytes = 0;
  std::int64_t compressed = 0;  ///< what a browser gets of them
  std::int64_t frames = 0;
  std::int64_t largest = 0;                           ///< bytes of a frame
  std::map<std::string, std::int64_t> sections = {};  ///< bytes of what they hold, by its name
};

/// Of a drive that makes its map in the time of its messages, so that every machine counts the same.
struct DriveTraffic {
  double seconds = 0;
  PageTraffic map;                     ///< a page that reads
  PageTraffic points;                  ///< one that shows the LiDAR's points too
  PageTraffic unread;                  ///< one that acknowledges nothing from its first frame on
  std::vector<semantic_tile_t> tiles;  ///< of the map at the end
};

/// Throws std::runtime_error when the log cannot be read or holds nothing of a drive.
[[nodiscard]] DriveTraffic measure_traffic(const std::string& log);

}  // namespace curbstone::bench::viewer
