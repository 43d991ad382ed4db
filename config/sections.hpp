#pragma once

#include <array>
#include <string_view>

namespace curbstone {

/// The sections of a vehicle's file beside `vehicle:`, one for each process that reads the file. A section of another
/// name is a mistake in the file. The programs know this list; the libraries beneath them do not.
inline constexpr std::array<std::string_view, 12> kProcessSections = {
    "lidar",        "imu",       "encoder",  "ekf",    "mapper", "tensor_voting",
    "semantic_map", "localizer", "recorder", "viewer", "relay",  "simulate"};

}  // namespace curbstone
