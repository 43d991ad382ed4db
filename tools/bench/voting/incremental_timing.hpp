#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "tools/bench/voting/cuda_fields.hpp"
#include "tools/bench/voting/inputs/mapped_drive.hpp"
#include "tools/bench/voting/scan_times.hpp"

namespace curbstone::bench::voting {

/// Voting on a growing map at both scales (sigma 0.1 m on 5 cm voxels, 0.3 m on 10 cm).
struct IncrementalTiming {
  int revolutions = 0;  ///< that brought points into the map; standing before the drive is not counted
  std::size_t points = 0;
  std::size_t voters = 0;  ///< at both scales together
  std::int64_t pairs = 0;  ///< computed, each for both of its ends
  ScanTimes voting;        ///< CPU time on one core: a revolution's points into both fields
  ScanTimes worker;  ///< CPU time on one core of all that a worker does: decode, vote, decompose, make pages, encode
  /// Message time from the newest points in a tile to the tile's VOTED_POINTS: what the mapper's and the worker's
  /// pacing come to (4 MB/s), without the time that anything takes. Each tile that was published counts once.
  double pacing_p50_ms = 0;
  double pacing_p95_ms = 0;
  double decomposition_ms = 0;         ///< of the worker's mean: changed tiles into VOTED_POINTS
  double max_relative_difference = 0;  ///< to the batch vote of the same points, of the tensor's norm
  std::optional<CudaGrowth> cuda;      ///< the same map on a GPU, where there is one
};

[[nodiscard]] IncrementalTiming time_incremental(const inputs::DriveSource& source);

}  // namespace curbstone::bench::voting
