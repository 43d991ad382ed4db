#pragma once

#include <cstdint>
#include <string_view>

#include "services/viewer/frames/byte_writer.hpp"
#include "services/viewer/frames/cloud_feed.hpp"
#include "services/viewer/frames/tile_steps.hpp"
#include "services/viewer/store/curb_lines.hpp"
#include "services/viewer/store/live_map.hpp"
#include "services/viewer/store/marking_lines.hpp"
#include "services/viewer/store/thinned_path.hpp"

namespace curbstone::viewer::frames {

/// A LiDAR point in base_link.
struct ScanPoint {
  std::int16_t x = 0, y = 0, z = 0;  ///< cm
  std::uint8_t intensity = 0;
};

/// @file
/// The sections of a frame; README.md has their layouts.

void write_begin(ByteWriter& out, double run, std::int32_t epoch);
/// Writes what a page that has the tiles up to `number` lacks: the shared steps if they start there, else whole tiles,
/// at most `max_tiles`. Returns the page's new number. Writes no section if the page lacks nothing.
std::uint64_t write_tiles(ByteWriter& out, const store::LiveMap& map, const TileSteps& steps, std::uint64_t number,
                          std::size_t max_tiles);
/// The same for curbs.
std::uint32_t write_curbs(ByteWriter& out, const store::CurbLines& curbs, std::uint32_t number);
/// The same for road markings.
std::uint32_t write_markings(ByteWriter& out, const store::MarkingLines& markings, std::uint32_t number);
/// Writes the points of the path from index `first` on. `everything`: the page discards the points it has.
void write_path(ByteWriter& out, const store::ThinnedPath& path, std::size_t first, bool everything);
void write_points(ByteWriter& out, const std::vector<ScanPoint>& points);
/// Writes what `feed` has for its page at `now`, us.
void write_cloud(ByteWriter& out, CloudFeed& feed, const store::DenseCloud& cloud, std::int64_t now);
void write_state(ByteWriter& out, std::string_view json);
void write_services(ByteWriter& out, std::string_view json);

}  // namespace curbstone::viewer::frames
