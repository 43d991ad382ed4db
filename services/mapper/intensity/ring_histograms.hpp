#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace curbstone::mapper::intensity {

/// For each ring of the LiDAR, the histogram of its intensities on the road that the vehicle drives on.
struct RingHistograms {
  using Counts = std::array<std::uint32_t, 256>;
  static constexpr std::size_t kMaxRings = 256;
  /// Limit of one ring and intensity, for validation: learning ends long before.
  static constexpr std::int64_t kMaxReturns = 10'000'000;

  std::int32_t scans = 0;     ///< number of scans counted
  std::vector<Counts> rings;  ///< by ring
  bool operator==(const RingHistograms&) const = default;
};

}  // namespace curbstone::mapper::intensity
