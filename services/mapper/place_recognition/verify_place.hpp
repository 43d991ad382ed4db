#pragma once

#include <optional>
#include <vector>

#include "services/mapper/place_recognition/candidate_search.hpp"
#include "services/mapper/place_recognition/scan_context.hpp"

namespace curbstone::mapper::place_recognition {

/// How much of the scan must be in the map.
enum class Known {
  kAll,   ///< all but a fifth
  kPart,  ///< two thirds, as beyond the map's end; but then nothing may contradict the map
};

/// The pose of a scan taken near the guess; nothing unless the evidence is firm and no other pose within the guess is
/// comparable. The result is nothing for a street that looks the same further along, a tunnel, an open square, or
/// another place. Some 50 ms for 5 m and 0.2 rad.
[[nodiscard]] std::optional<PlaceMatch> verify_place(const std::vector<scan::LidarPoint>& points,
                                                     const PlaceGuess& guess,
                                                     const std::vector<const scan::Keyframe*>& nodes,
                                                     const config::IcpConfig& config, const Eigen::Vector3d& lidar,
                                                     Known known = Known::kAll);

/// The same if only the attitude is known: roll and pitch of `T_map_base`. `index` holds the nodes by their index in
/// `nodes`; any similar place on the map counts as runner-up. Some 0.3 s.
[[nodiscard]] std::optional<PlaceMatch> verify_place(const std::vector<scan::LidarPoint>& points,
                                                     const Pose& T_map_base, const ScanContext& index,
                                                     const std::vector<const scan::Keyframe*>& nodes,
                                                     const config::IcpConfig& config, const Eigen::Vector3d& lidar,
                                                     Known known = Known::kAll);

}  // namespace curbstone::mapper::place_recognition
