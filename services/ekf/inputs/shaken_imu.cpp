#include "services/ekf/inputs/shaken_imu.hpp"

#include <cmath>

#include "common/geometry/gravity.hpp"

namespace curbstone::ekf::inputs {

double ShakenImu::tilt_sigma() const {
  const ImuNoise::Excess excess = noise_.beyond(config_);
  if (excess.gyro == 0.0 && excess.accelerometer == 0.0) return 0.0;
  const base::NoiseConfig applied = noise_.applied_to(config_);
  return std::sqrt(applied.gyro * applied.accelerometer / kGravity);
}

bool ShakenImu::add(const base::ImuSample& sample) {
  noise_.add(sample);
  const double sigma = tilt_sigma();
  const double limit = kDrop * level_sigma_;
  if (!shaken_) {
    shaken_ = sigma > limit;
    calm_ = false;
    return shaken_;
  }
  const bool calm = sigma < 0.5 * limit;
  if (calm && (!calm_ || sample.utime < calm_since_)) calm_since_ = sample.utime;
  calm_ = calm;
  if (calm_ && sample.utime - calm_since_ >= kTrust) shaken_ = false;
  return shaken_;
}

}  // namespace curbstone::ekf::inputs
