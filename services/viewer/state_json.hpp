#pragma once

#include <cstdint>
#include <curbstone/map_pose_t.hpp>
#include <optional>
#include <string>

#include "common/config/vehicle.hpp"
#include "services/viewer/store/services.hpp"

namespace curbstone::viewer {

/// How far a log has been played.
struct Playback {
  double position = 0;  ///< s since the first record
  double progress = 0;  ///< 0 .. 1, the share of the log that was read
  double speed = 1;     ///< times real time
  bool paused = false;
  bool ended = false;
};

/// The present state as the pages show it. Ages are in s since the last message; NaN: there was none.
struct State {
  std::string source;  ///< "live", "map" (saved) or "replay"
  std::string title;   ///< of what is shown, for people; for example a file name
  std::int32_t epoch = 0;
  std::size_t tiles = 0;
  std::size_t behind = 0;  ///< tiles announced but not received yet
  double bus_age = 0;      ///< of any message
  double tile_age = 0;
  double index_age = 0;  ///< of TILE_INDEX of the map shown: semantic_map sends it each second, also at a standstill
  double pose_age = 0;
  double new_map_age = 0;  ///< s of the drive since a map began that does not continue the one before; NaN: none did
  double latency_p50 = 0;  ///< s, from the LiDAR's measurement to the drawn frame; NaN: no frame was drawn
  double latency_p95 = 0;
  std::optional<map_pose_t> pose;
  std::optional<map_pose_t> localized;  ///< LOCALIZED_POSE; drawn if its map is the one shown
  double localized_age = 0;
  std::optional<Playback> playback;  ///< only of a "replay"
};

/// As JSON, valid UTF-8 whatever the bus delivered. frames/README.md has the section it goes into; page/world.ts reads
/// it.
[[nodiscard]] std::string state_json(const State& state, const VehicleConfig& vehicle);
[[nodiscard]] std::string services_json(const store::Services& services, std::int64_t now);

}  // namespace curbstone::viewer
