#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "services/mapper/intensity/ring_histograms.hpp"

namespace curbstone::mapper::intensity {

/// State of a ring.
enum class RingState : std::uint8_t {
  kUnknown,  ///< too little road seen; rings above the horizon stay in this state
  kLearned,
  kDead,       ///< hardly any return has an intensity
  kSaturated,  ///< the road gives the highest intensity
};

/// Puts the intensities of all rings on one scale: for each ring 256 entries. The median of a ring's returns from the
/// road maps to 64 of 255, the distance between their quartiles to 16, linearly, within 1..255. 0 means no intensity:
/// the return had none, or its ring is not learned. Immutable.
class RingTable {
 public:
  static constexpr double kMedian = 64;
  static constexpr double kQuartiles = 16;  ///< distance between them

  /// A table without learned rings.
  RingTable() = default;
  explicit RingTable(const RingHistograms& histograms);

  [[nodiscard]] std::uint8_t of(std::uint8_t ring, std::uint8_t raw) const {
    return ring < rings_.size() ? rings_[ring].entries[raw] : std::uint8_t{0};
  }
  [[nodiscard]] RingState state(std::uint8_t ring) const {
    return ring < rings_.size() ? rings_[ring].state : RingState::kUnknown;
  }
  [[nodiscard]] int count(RingState state) const;  ///< number of rings in this state

 private:
  struct Ring {
    RingState state = RingState::kUnknown;
    std::array<std::uint8_t, 256> entries{};
  };
  static Ring ring_of(const RingHistograms::Counts& counts);

  std::vector<Ring> rings_;
};

}  // namespace curbstone::mapper::intensity
