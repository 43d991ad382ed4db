#pragma once

#include <algorithm>
#include <cstdint>

namespace curbstone::imu {

/// Detects that an IMU is at the end of its range for long: not the shock of a kerb, but a range that does not fit the
/// vehicle or its mount. Good samples between clipped ones do not end it unless they last for kPause. Pure; us.
class ClipWatch {
 public:
  static constexpr std::int64_t kLasting = 1'000'000;
  static constexpr std::int64_t kPause = 200'000;

  void add(std::int64_t time, bool clips) {
    if (clips) {
      since_ = clipping_ ? std::min(since_, time) : time;
      clipping_ = true;
      last_ = time;
    } else if (time - last_ > kPause || time < since_) {
      clipping_ = false;
    }
  }
  [[nodiscard]] bool lasting() const { return clipping_ && last_ - since_ > kLasting; }

 private:
  bool clipping_ = false;
  std::int64_t since_ = 0;
  std::int64_t last_ = 0;
};

}  // namespace curbstone::imu
