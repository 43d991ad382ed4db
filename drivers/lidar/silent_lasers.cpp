#include "drivers/lidar/silent_lasers.hpp"

#include <algorithm>

namespace curbstone::lidar {
namespace {

constexpr std::int64_t kInterval = 1'000'000;  // us
constexpr int kMany = 50;                      // returns in a second: an object that all lasers near its height can see
constexpr std::size_t kNear = 3;  // rings, of which one must have returns: two neighbours may fail together

}  // namespace

void SilentLasers::add(std::int64_t utime, std::span<const std::uint8_t> rings) {
  const std::int64_t second = utime / kInterval;
  if (second_ != second) {
    // A second that was cut short by a jump in time is not evaluated.
    if (second_ && second == *second_ + 1) close_second();
    returns_.fill(0);
    second_ = second;
  }
  for (const std::uint8_t ring : rings) ++returns_[ring];
}

void SilentLasers::close_second() {
  for (std::size_t ring = 0; ring < lasers_.size(); ++ring) {
    Laser& laser = lasers_[ring];
    if (returns_[ring] >= kMany) {
      laser = {.steady = std::min(laser.steady + 1, kSteady)};
    } else if (returns_[ring] > 0) {
      laser = {};
    } else if (laser.steady == kSteady && is_between_others(ring)) {
      laser.silent_for = std::min(laser.silent_for + 1, kSilence);
    } else if (laser.silent_for < kSilence) {  // otherwise only a return ends it
      laser = {};
    }
  }
}

bool SilentLasers::is_between_others(std::size_t ring) const {
  const auto returns = [&](std::size_t other) { return returns_[other] >= kMany; };
  bool is_above = false;
  bool is_below = ring == 0;  // the lowest laser points at the ground
  for (std::size_t apart = 1; apart <= kNear; ++apart) {
    is_above = is_above || (ring + apart < lasers_.size() && returns(ring + apart));
    is_below = is_below || (ring >= apart && returns(ring - apart));
  }
  return is_above && is_below;
}

std::vector<int> SilentLasers::silent() const {
  std::vector<int> rings;
  for (std::size_t ring = 0; ring < lasers_.size(); ++ring) {
    if (lasers_[ring].silent_for >= kSilence) rings.push_back(static_cast<int>(ring));
  }
  return rings;
}

}  // namespace curbstone::lidar
