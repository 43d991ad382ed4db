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
  double position = 0;  ///< s since its first record
  double progress = 0;  ///< 0 .. 1, the part of it that has been read
  double speed = 1;     ///< times the pace of the drive
  bool paused = false;
  bool ended = false;
};

/// What the pages show of the present moment. Ages are in s since something came; NaN: it never did.
struct State {
  std::string source;  ///< "live", "map" (saved) or "replay"
  std::string title;   ///< what is seen, for people: a file, say
  std::int32_t epoch = 0;
  std::size_t tiles = 0;
  std::size_t behind = 0;  ///< tiles that were announced and did not come yet
  double bus_age = 0;      ///< of any message
  double tile_age = 0;
  double pose_age = 0;
  double latency_p50 = 0;  ///< s, from the LiDAR's measurement to the drawn frame; NaN: none was drawn
  double latency_p95 = 0;
  std::optional<map_pose_t> pose;
  std::optional<map_pose_t> localized;  ///< LOCALIZED_POSE; drawn where its map is the one that is seen
  double localized_age = 0;
  std::optional<Playback> playback;  ///< of a "replay"
};

/// JSON, UTF-8 whatever came from the bus. README.md of frames/ tells where it goes; page/world.ts reads it.
[[nodiscard]] std::string state_json(const State& state, const VehicleConfig& vehicle);
[[nodiscard]] std::string services_json(const store::Services& services, std::int64_t now);

}  // namespace curbstone::viewer
