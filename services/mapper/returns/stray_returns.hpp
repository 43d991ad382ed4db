#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::returns {

/// Detects drops, flakes, dust, exhaust, or mirror images in a wet road, and removes their returns: in the map these
/// would be obstacles all over the road, and holes in it.
///
/// A return is stray if its neighbours of the same laser agree with each other but not with it, and if no return of the
/// lasers above and below is near it either: something that a single beam meets, in front of or behind a surface. In
/// dry air, less than one return in a thousand is stray. If more than kMany of the returns within kReach are, for
/// kLooks revolutions in a row, all returns without a near neighbour are removed, until fewer than kFew are stray.
/// Isolated objects narrower than two beams (a wire, a twig) are removed with them during that time.
///
/// A function of the scans alone. Pure; one thread. Counters: withheld.stray, strays (times that removal began).
class StrayReturns {
 public:
  static constexpr float kReach = 25.0F;  ///< m
  static constexpr double kMany = 0.004;
  static constexpr double kFew = 0.002;
  static constexpr int kLooks = 20;  ///< revolutions

  /// Judges a revolution, and removes its stray returns while removal is on.
  void filter(scan::Scan& scan);
  [[nodiscard]] bool filters() const { return filters_; }
  /// Share of stray returns within kReach, in the last revolution.
  [[nodiscard]] double share() const { return share_; }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  /// The returns of each laser, in order of time. Kept to reuse its memory.
  struct Rings {
    std::vector<float> range;  // m, by the point's index
    std::array<std::vector<std::uint32_t>, 256> of;

    void sort(const std::vector<scan::LidarPoint>& points);
  };
  class Neighbours;
  void judge();

  Rings rings_;
  double share_ = 0;
  int looks_ = 0;  // in a row that contradict `filters_`
  bool filters_ = false;
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
