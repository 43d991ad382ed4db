#pragma once

#include <cstdlib>

namespace curbstone::lidar::models::robosense {

/// Whether the head turns at another speed than the one that is set. Two consecutive device informations must say so:
/// one may be damaged.
class SpeedWatch {
 public:
  /// rpm; 0: not reported, as by old firmware.
  [[nodiscard]] bool is_wrong(int set, int measured) {
    constexpr int kTolerance = 20;  // a part of this many
    const bool differs = measured != 0 && set != 0 && kTolerance * std::abs(measured - set) > set;
    const bool twice = differs && differed_;
    differed_ = differs;
    return twice;
  }

 private:
  bool differed_ = false;
};

}  // namespace curbstone::lidar::models::robosense
