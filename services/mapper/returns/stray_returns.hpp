#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::returns {

/// Finds out when drops, flakes, dust or exhaust, or mirror images in a wet road, are among the returns, and takes them
/// out while they are: in the map they are obstacles all over the road, and holes in it.
///
/// A return is stray where those beside it, of the same laser, agree with each other and not with it, and where those
/// of the lasers above and below are not beside it either: a thing that one beam alone meets, before or behind a
/// surface. In dry air less than one in a thousand is. Where more than kMany of the returns within kReach are for
/// kLooks revolutions in a row, all that nothing stands beside are taken out, until fewer than kFew are. What stands on
/// its own and is narrower than two beams (a wire, a twig) goes with them, for as long.
///
/// A function of the scans alone. Pure; one thread. Counters: withheld.stray, strays (times that it began).
class StrayReturns {
 public:
  static constexpr float kReach = 25.0F;  ///< m
  static constexpr double kMany = 0.004;
  static constexpr double kFew = 0.002;
  static constexpr int kLooks = 20;  ///< revolutions

  /// Judges a revolution, and takes what is stray out of it where there is much.
  void filter(scan::Scan& scan);
  [[nodiscard]] bool filters() const { return filters_; }
  /// Of the last revolution: share of the returns within kReach.
  [[nodiscard]] double share() const { return share_; }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  /// The returns of each laser, in the order in which they were taken. Kept for the sake of its memory.
  struct Rings {
    std::vector<float> range;  // m, by the point's index
    std::array<std::vector<std::uint32_t>, 256> of;

    void sort(const std::vector<scan::LidarPoint>& points);
  };
  class Neighbours;
  void judge();

  Rings rings_;
  double share_ = 0;
  int looks_ = 0;  // in a row that say the other thing
  bool filters_ = false;
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
