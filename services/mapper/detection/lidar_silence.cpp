#include "services/mapper/detection/lidar_silence.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace curbstone::mapper::detection {

void LidarSilence::tick(std::int64_t now) {
  if (ticked_ != 0) silent_ += std::clamp<std::int64_t>(now - ticked_, 0, kMostPerTick);
  ticked_ = now;
}

void LidarSilence::heard() {
  was_heard_ = true;
  silent_ = 0;
}

void LidarSilence::add_faults(std::vector<std::string>& faults) const {
  if (!was_heard_ || silent_ <= kSilent) return;
  faults.push_back(fmt::format(
      "LiDAR: silent for {:.1f} s: nothing is mapped. Check its cable and power, and the faults of its driver",
      static_cast<double>(silent_) * 1e-6));
}

}  // namespace curbstone::mapper::detection
