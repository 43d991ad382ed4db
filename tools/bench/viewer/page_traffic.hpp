#pragma once

#include <cstdint>
#include <curbstone/semantic_tile_t.hpp>
#include <map>
#include <string>
#include <vector>

namespace curbstone::bench::viewer {

/// The traffic to one page.
struct PageTraffic {
  std::int64_t bytes = 0;
  std::int64_t compressed = 0;  ///< after compression, as a browser gets them
  std::int64_t frames = 0;
  std::int64_t largest = 0;                           ///< bytes of the largest frame
  std::map<std::string, std::int64_t> sections = {};  ///< bytes of content, by name of the section
};

/// The traffic of a drive that is mapped on the clock of its messages, so that the figures are the same on every
/// machine.
struct DriveTraffic {
  double seconds = 0;
  PageTraffic map;                     ///< a page that reads everything
  PageTraffic points;                  ///< one that also shows the LiDAR's points
  PageTraffic cloud;                   ///< one that shows the dense cloud with its saliencies
  PageTraffic unread;                  ///< one that acknowledges nothing after its first frame
  std::vector<semantic_tile_t> tiles;  ///< of the map at the end
};

/// Throws std::runtime_error if the log cannot be read or has no data of a drive.
[[nodiscard]] DriveTraffic measure_traffic(const std::string& log);

}  // namespace curbstone::bench::viewer
