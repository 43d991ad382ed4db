#pragma once

#include <optional>
#include <string>

namespace curbstone::lidar::models::robosense {

/// Whether the head turns at another speed than the one that is set. Two consecutive device informations must say so:
/// one may be damaged.
class SpeedWatch {
 public:
  /// Returns the fault in words. rpm; 0: not reported, as by old firmware.
  [[nodiscard]] std::optional<std::string> check(int set, int measured);

 private:
  bool differed_ = false;
};

}  // namespace curbstone::lidar::models::robosense
