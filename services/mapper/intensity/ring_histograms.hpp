#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace curbstone::mapper::intensity {

/// How often each ring of the LiDAR reported each intensity, of the road that the vehicle drives on.
struct RingHistograms {
  using Counts = std::array<std::uint32_t, 256>;
  static constexpr std::size_t kMostRings = 256;
  /// Of one ring and intensity; what claims more is none: the learning ends long before.
  static constexpr std::int64_t kMostReturns = 10'000'000;

  std::int32_t scans = 0;     ///< that they are of
  std::vector<Counts> rings;  ///< by ring
  bool operator==(const RingHistograms&) const = default;
};

}  // namespace curbstone::mapper::intensity
