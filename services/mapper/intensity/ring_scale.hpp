#pragma once

#include <memory>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/intensity/ring_histograms.hpp"
#include "services/mapper/intensity/ring_table.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::intensity {

/// Learns each ring's intensities on the road, and from them the table that puts all rings on one scale. Road is where
/// the vehicle drives or has driven: low returns in a strip of its width, ahead and behind. A table is made after 10
/// scans and again after each doubling. It is final after 1280 scans, some 250 m, so that everything mapped later is on
/// one scale. A function of the sequence of calls alone. Pure; one thread.
///
/// Counters: intensity.tables, intensity.dead_rings, intensity.saturated_rings (of each table).
class RingScale {
 public:
  RingScale() : table_(std::make_shared<const RingTable>()) {}

  /// Continues from the basis() of an earlier instance.
  void restore(RingHistograms basis);
  /// Takes a scan that fits the map; `points` de-skewed, in base_link. After the first, a scan is used only if the
  /// vehicle has moved on.
  void learn(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base);

  /// The current table. Never null; a table that has been handed out does not change.
  [[nodiscard]] const std::shared_ptr<const RingTable>& table() const { return table_; }
  /// The histograms that the table was made from.
  [[nodiscard]] const RingHistograms& basis() const { return basis_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  void make_table();

  RingHistograms learned_;  // histograms so far
  RingHistograms basis_;
  std::shared_ptr<const RingTable> table_;
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();  // of base_link in map, at the last scan used
  Counters counters_;
};

}  // namespace curbstone::mapper::intensity
