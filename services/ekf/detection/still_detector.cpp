#include "services/ekf/detection/still_detector.hpp"

#include <algorithm>

namespace curbstone::ekf::detection {

namespace {

constexpr std::size_t kMaxStillSamples = 4096;  // bound, whatever the stamps say
constexpr double kManyTravels = 20.0;
constexpr double kOfNoise = 1.3;  // times the noise's standard deviation: that of a single window varies

/// Drops samples that are not needed to cover `window` seconds up to the newest: one sample may be older.
template <class Sample>
void trim(std::deque<Sample>& samples, double window) {
  while (samples.size() > 2 && base::seconds_between(samples[1].utime, samples.back().utime) >= window)
    samples.pop_front();
  if (samples.size() > kMaxStillSamples) samples.pop_front();
}

template <class Sample>
double span_of(const std::deque<Sample>& samples) {
  return samples.empty() ? 0.0 : base::seconds_between(samples.front().utime, samples.back().utime);
}

}  // namespace

void StillDetector::add(const base::ImuSample& sample) {
  imu_.push_back(sample);
  trim(imu_, config_.window);
  const auto n = static_cast<double>(imu_.size());
  mean_rate_.setZero();
  mean_acceleration_.setZero();
  for (const base::ImuSample& s : imu_) {
    mean_rate_ += s.angular_rate / n;
    mean_acceleration_ += s.acceleration / n;
  }
  Eigen::Array3d rate_variance = Eigen::Array3d::Zero();
  Eigen::Array3d acceleration_variance = Eigen::Array3d::Zero();
  for (const base::ImuSample& s : imu_) {
    rate_variance += (s.angular_rate - mean_rate_).array().square() / n;
    acceleration_variance += (s.acceleration - mean_acceleration_).array().square() / n;
  }
  // A single sample that is far off ends the standstill before the variance shows it.
  const double gyro_std = std::max(config_.gyro_std, kOfNoise * noise_[0]);
  const double acceleration_std = std::max(config_.acceleration_std, kOfNoise * noise_[1]);
  const bool jerked = (sample.angular_rate - mean_rate_).cwiseAbs().maxCoeff() > 5.0 * gyro_std ||
                      (sample.acceleration - mean_acceleration_).cwiseAbs().maxCoeff() > 5.0 * acceleration_std;
  quiet_ = !jerked && rate_variance.sqrt().maxCoeff() <= gyro_std &&
           acceleration_variance.sqrt().maxCoeff() <= acceleration_std;
}

void StillDetector::add(const base::WheelSample& sample) {
  wheels_.push_back(sample);
  trim(wheels_, config_.window);
}

void StillDetector::reset() {
  imu_.clear();
  wheels_.clear();
  quiet_ = false;
}

double StillDetector::span() const {
  return span_of(imu_);
}

std::array<double, 2> StillDetector::travel() const {
  std::array<double, 2> out = {};
  for (std::size_t i = 0; i < 2 && !wheels_.empty(); ++i) {
    const auto [low, high] = std::minmax_element(
        wheels_.begin(), wheels_.end(),
        [i](const base::WheelSample& a, const base::WheelSample& b) { return a.angle[i] < b.angle[i]; });
    out[i] = radius_ * (high->angle[i] - low->angle[i]);
  }
  return out;
}

bool StillDetector::still(const Eigen::Vector3d& gyro_bias) const {
  if (!quiet_ || wheels_.size() < 2) return false;
  const bool covered = span_of(imu_) >= config_.window && span_of(wheels_) >= 0.9 * config_.window &&
                       base::seconds_between(wheels_.back().utime, imu_.back().utime) <= max_wheel_gap_;
  if (!covered) return false;
  return wheels_rest() && (mean_rate_ - gyro_bias).cwiseAbs().maxCoeff() <= config_.max_rate;
}

bool StillDetector::wheels_rest() const {
  const std::array<double, 2> moved = travel();
  return span_of(wheels_) >= 0.9 * config_.window && moved[0] <= config_.travel && moved[1] <= config_.travel;
}

bool StillDetector::wheels_turn() const {
  const std::array<double, 2> moved = travel();
  return std::max(moved[0], moved[1]) > kManyTravels * config_.travel;
}

}  // namespace curbstone::ekf::detection
