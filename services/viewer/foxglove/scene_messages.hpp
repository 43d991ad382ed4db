#pragma once

#include <cstdint>
#include <string>

#include "services/viewer/store/curb_lines.hpp"
#include "services/viewer/store/marking_lines.hpp"
#include "services/viewer/store/thinned_path.hpp"

namespace curbstone::viewer::foxglove {

/// foxglove.SceneUpdate in map, as protobuf. An entity that comes again under its id replaces the one before, and stays
/// until then.

/// An entity a curb line: one line along its foot and one along its upper edge; lowered ones are orange, inferred ones
/// grey and half transparent. Metadata: height, rise, confidence, lowered, inferred. `utime`: us since the Unix epoch.
[[nodiscard]] std::string curbs_message(const store::CurbLines::Changes& changes, std::int64_t utime);

/// An entity a road marking: its painted pieces as flat strips, as wide as the paint, just over the road. Metadata:
/// type, width, dash, gap, confidence. `utime`: us since the Unix epoch.
[[nodiscard]] std::string markings_message(const store::MarkingLines::Changes& changes, std::int64_t utime);

/// Points of the path in an entity; the next one begins with its last point.
inline constexpr std::size_t kPathPiece = 200;
/// The pieces in which points from `first` on stand. `everything`: what was sent before is void.
[[nodiscard]] std::string path_message(const store::ThinnedPath& path, std::size_t first, bool everything,
                                       std::int64_t utime);

}  // namespace curbstone::viewer::foxglove
