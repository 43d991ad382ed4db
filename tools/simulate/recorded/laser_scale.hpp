#pragma once

#include "services/mapper/intensity/ring_table.hpp"
#include "tools/simulate/recorded/scan_set.hpp"

namespace curbstone::simulate::recorded {

/// One scale for the intensities of all lasers of a recording, as the mapper has it: learned on the strip of road ahead
/// and behind, `height` m below the lidar, of up to 40 of its scans. An emulated beam takes the intensity of the
/// nearest laser, so without it one ring would mix the scales of several. A laser that sees too little road keeps its
/// own.
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
