#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/mapper/journal/recorded_drive.hpp"

namespace curbstone::mapper::journal {

/// A part of the map that scans are registered to: a batch of its file.
struct LocalMapPart {
  std::string config_hash;
  std::int32_t epoch = 0;
  std::int64_t utime = 0;  ///< us: with this part the file has all of the map as of that scan; 0: more follows
  std::vector<std::vector<registration::VoxelSums>> levels;
};

/// The items of its batch: see make_batch().
[[nodiscard]] std::string encoded(const LocalMapPart& part);

/// The map in the file of a mapper with the same settings in the same epoch. Nothing if there is no file, or it is of
/// another drive or epoch, incomplete or damaged: then the map can be rebuilt from keyframes.
[[nodiscard]] std::optional<RecordedLocalMap> read_local_map(const std::string& path, const std::string& config_hash,
                                                             std::int32_t epoch);

}  // namespace curbstone::mapper::journal
