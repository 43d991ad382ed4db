#pragma once

#include <cstdint>
#include <string>

#include "services/viewer/store/curb_lines.hpp"
#include "services/viewer/store/marking_lines.hpp"
#include "services/viewer/store/thinned_path.hpp"

namespace curbstone::viewer::foxglove {

/// Messages foxglove.SceneUpdate in map, as protobuf. An entity persists until another one with the same id replaces
/// it.

/// One entity per curb line: a line along its foot and a line along its upper edge. Lowered curbs are orange, inferred
/// ones grey and half transparent. Metadata: height, rise, confidence, lowered, inferred. `utime`: us since the Unix
/// epoch.
[[nodiscard]] std::string curbs_message(const store::CurbLines::Changes& changes, std::int64_t utime);

/// One entity per road marking: its painted pieces as flat strips of the paint's width, just above the road. Metadata:
/// type, width, dash, gap, confidence. `utime`: us since the Unix epoch.
[[nodiscard]] std::string markings_message(const store::MarkingLines::Changes& changes, std::int64_t utime);

/// Points of the path per entity. Each entity begins with the last point of the one before.
inline constexpr std::size_t kPathPiece = 200;
/// The entities that hold the points from index `first` on. `everything`: they replace all that was sent before.
[[nodiscard]] std::string path_message(const store::ThinnedPath& path, std::size_t first, bool everything,
                                       std::int64_t utime);

}  // namespace curbstone::viewer::foxglove
