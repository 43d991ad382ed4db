#pragma once

#include <optional>
#include <vector>

#include "services/mapper/place_recognition/candidate_search.hpp"
#include "services/mapper/place_recognition/scan_context.hpp"

namespace curbstone::mapper::place_recognition {

/// How much of what a scan shows must be in the map.
enum class Known {
  kAll,   ///< but for a fifth
  kPart,  ///< two thirds, as beyond the map's end; but then nothing may contradict it
};

/// The place of a scan that was taken about where the guess says; nothing unless the figures are firm and no
/// other pose within the guess comes near them. A street that looks the same further along, a tunnel, an open square,
/// another place: nothing. Some 50 ms for 5 m and 0.2 rad.
[[nodiscard]] std::optional<PlaceMatch> verify_place(const std::vector<scan::LidarPoint>& points,
                                                     const PlaceGuess& guess,
                                                     const std::vector<const scan::Keyframe*>& nodes,
                                                     const config::IcpConfig& config, const Eigen::Vector3d& lidar,
                                                     Known known = Known::kAll);

/// The same where nothing is known but the attitude: roll and pitch of `T_map_base`. `index` holds the nodes by their
/// place in `nodes`; whatever looks alike anywhere counts as runner-up. Some 0.3 s.
[[nodiscard]] std::optional<PlaceMatch> verify_place(const std::vector<scan::LidarPoint>& points,
                                                     const Pose& T_map_base, const ScanContext& index,
                                                     const std::vector<const scan::Keyframe*>& nodes,
                                                     const config::IcpConfig& config, const Eigen::Vector3d& lidar,
                                                     Known known = Known::kAll);

}  // namespace curbstone::mapper::place_recognition
