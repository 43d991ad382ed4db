#pragma once

#include "services/mapper/intensity/ring_table.hpp"
#include "tools/simulate/recorded/scan_set.hpp"

namespace curbstone::simulate::recorded {

/// A common intensity scale for all lasers of a recording, as in the mapper: learned on the strip of road ahead and
/// behind, `height` m below the lidar, from up to 40 of its scans. An emulated beam takes the intensity of the nearest
/// laser, so without a common scale one ring would mix several. A laser that hits too little road keeps its own scale.
class LaserScale {
 public:
  LaserScale(const ScanSet& scans, double height);

  [[nodiscard]] std::uint8_t of(const ScanPoint& point) const {
    const bool known = table_.state(point.laser) != mapper::intensity::RingState::kUnknown;
    return known ? table_.of(point.laser, point.intensity) : point.intensity;
  }
  [[nodiscard]] const mapper::intensity::RingTable& table() const { return table_; }

 private:
  mapper::intensity::RingTable table_;
};

}  // namespace curbstone::simulate::recorded
