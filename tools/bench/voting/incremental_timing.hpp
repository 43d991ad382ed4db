#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "tools/bench/voting/cuda_fields.hpp"
#include "tools/bench/voting/inputs/mapped_drive.hpp"
#include "tools/bench/voting/scan_times.hpp"

namespace curbstone::bench::voting {

/// Figures of voting on a growing map at both scales (sigma 0.1 m on 5 cm voxels, 0.3 m on 10 cm).
struct IncrementalTiming {
  int revolutions = 0;  ///< that added points to the map; standing before the drive does not count
  std::size_t points = 0;
  std::size_t voters = 0;  ///< at both scales together
  std::int64_t pairs = 0;  ///< computed; each serves both of its points
  ScanTimes voting;        ///< CPU time on one core: adding a revolution's points to both fields
  ScanTimes worker;  ///< CPU time on one core of all of a worker's work: decode, vote, decompose, make pages, encode
  /// Message time from the newest points in a tile to the tile's VOTED_POINTS: the delay by the mapper's and the
  /// worker's pacing (4 MB/s), without any computing time. Each published tile counts once.
  double pacing_p50_ms = 0;
  double pacing_p95_ms = 0;
  double decomposition_ms = 0;         ///< part of the worker's mean: from changed tiles to VOTED_POINTS
  double max_relative_difference = 0;  ///< to the batch vote of the same points, relative to the tensor's norm
  std::optional<CudaGrowth> cuda;      ///< the same map on a GPU, if there is one
};

[[nodiscard]] IncrementalTiming time_incremental(const inputs::DriveSource& source);

}  // namespace curbstone::bench::voting
