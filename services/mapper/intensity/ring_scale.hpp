#pragma once

#include <memory>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/intensity/ring_histograms.hpp"
#include "services/mapper/intensity/ring_table.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::intensity {

/// Learns from the scans what each ring makes of the road, and with it the table that puts all rings on one scale. Road
/// is where the vehicle drives or has driven: low returns in a strip as wide as it is, ahead and behind. A table is
/// made after 10 scans, anew after each doubling, and stands after 1280, which take some 250 m: what is mapped later is
/// on the same scale. A function of the sequence of calls alone. Pure; one thread.
///
/// Counters: intensity.tables, intensity.dead_rings, intensity.saturated_rings (of each table).
class RingScale {
 public:
  RingScale() : table_(std::make_shared<const RingTable>()) {}

  /// Goes on where another left off: what basis() gave.
  void restore(RingHistograms basis);
  /// A scan that fits the map; `points` de-skewed, in base_link. Taken only where the vehicle has moved on, but for the
  /// first.
  void learn(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base);

  /// Never null; what is shared does not change.
  [[nodiscard]] const std::shared_ptr<const RingTable>& table() const { return table_; }
  /// What the table was made of.
  [[nodiscard]] const RingHistograms& basis() const { return basis_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  void make_table();

  RingHistograms learned_;  // until now
  RingHistograms basis_;
  std::shared_ptr<const RingTable> table_;
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();  // of base_link in map, when the last scan was taken
  Counters counters_;
};

}  // namespace curbstone::mapper::intensity
