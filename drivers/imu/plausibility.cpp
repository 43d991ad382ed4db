#include "drivers/imu/plausibility.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/geometry/gravity.hpp"

namespace curbstone::imu {

namespace {

constexpr std::int64_t kSecond = 1'000'000;  // us
constexpr std::int64_t kPause = kSecond;     // us without a sample after which everything restarts
constexpr std::int64_t kFrozen = kSecond / 20;
constexpr int kMinFrozen = 5;  // equal samples
constexpr std::int64_t kAllAxes = 2 * kSecond;
constexpr std::int64_t kTwoAxes = 3 * kSecond;
constexpr std::int64_t kOneAxis = 10 * kSecond;
constexpr std::int64_t kInMotion = 3 * kSecond;
constexpr std::int64_t kTurning = kSecond / 2;
constexpr double kNoBias = 0.1;   // rad/s
constexpr double kMotion = 1.0;   // m/s^2, between the smallest and the largest value of a second
constexpr std::size_t kMean = 3;  // s
constexpr double kMinForce = 0.8 * kGravity;
constexpr double kMaxForce = 1.45 * kGravity;

double mean_force(const std::vector<std::array<double, 3>>& means) {
  std::array<double, 3> sum{};
  for (const auto& mean : means) {
    for (std::size_t i = 0; i < 3; ++i) sum[i] += mean[i] / static_cast<double>(means.size());
  }
  return std::hypot(sum[0], sum[1], sum[2]);
}

}  // namespace

void Plausibility::Held::add(std::int64_t time, double now) {
  if (samples == 0 || std::bit_cast<std::uint64_t>(now) != std::bit_cast<std::uint64_t>(value)) {
    value = now;
    since = time;
    samples = 0;
  }
  samples = std::min(samples + 1, kMinEqual);
}

bool Plausibility::Held::lasts(std::int64_t time, std::int64_t us, int least) const {
  return samples >= least && time - since >= us;
}

void Plausibility::begin(std::int64_t time) {
  *this = Plausibility();
  second_ = time;
}

void Plausibility::end_second(std::int64_t time) {
  bool moves = false;
  for (std::size_t i = 0; i < 3; ++i) {
    moves = moves || most_[i] - least_[i] > kMotion;
    sum_[i] /= samples_;
  }
  moving_ = moves ? moving_ + 1 : 0;
  if (means_.size() == kMean) means_.erase(means_.begin());
  means_.push_back(sum_);
  const auto fits = [](double force) { return force >= kMinForce && force <= kMaxForce; };
  if (!gravity_ && fits(mean_force({sum_}))) {
    gravity_ = true;
    means_ = {sum_};
  } else if (means_.size() == kMean) {
    gravity_ = fits(mean_force(means_));
  }
  second_ = time;
  samples_ = 0;
}

Plausibility::Verdict Plausibility::judge(std::int64_t time, const std::array<double, 3>& acceleration,
                                          const std::array<double, 3>& rate, bool fine_steps) {
  if (last_ == 0 || time < last_ || time - last_ > kPause) begin(time);
  last_ = time;
  if (time - second_ >= kSecond && samples_ > 0) end_second(time);
  for (std::size_t i = 0; i < 3; ++i) {
    acceleration_[i].add(time, acceleration[i]);
    rate_[i].add(time, rate[i]);
    sum_[i] = samples_ == 0 ? acceleration[i] : sum_[i] + acceleration[i];
    least_[i] = samples_ == 0 ? acceleration[i] : std::min(least_[i], acceleration[i]);
    most_[i] = samples_ == 0 ? acceleration[i] : std::max(most_[i], acceleration[i]);
  }
  ++samples_;
  for (std::size_t i = 0; i < 3; ++i)
    stuck_axes_[i] = std::abs(rate_[i].value) >= kNoBias && rate_[i].lasts(time, kTurning);
  if (fine_steps && frozen(time)) return Verdict::kFrozen;
  if (accelerometer_stuck(time)) return Verdict::kStuckAccelerometer;
  if (gyro_stuck(time)) return Verdict::kStuckGyro;
  return gravity_ ? Verdict::kGood : Verdict::kNotGravity;
}

bool Plausibility::moves() const {
  return moving_ * kSecond >= kInMotion;
}

bool Plausibility::all_last(const std::array<Held, 3>& axes, std::int64_t time, std::int64_t us) {
  return std::ranges::all_of(axes, [&](const Held& axis) { return axis.lasts(time, us); });
}

bool Plausibility::frozen(std::int64_t time) const {
  const auto lasts = [&](const Held& axis) { return axis.lasts(time, kFrozen, kMinFrozen); };
  return std::ranges::all_of(acceleration_, lasts) && std::ranges::all_of(rate_, lasts);
}

bool Plausibility::accelerometer_stuck(std::int64_t time) const {
  const std::int64_t one = moves() ? kInMotion : kOneAxis;
  const auto lasting = [&](std::int64_t us) {
    return std::ranges::count_if(acceleration_, [&](const Held& axis) { return axis.lasts(time, us); });
  };
  return lasting(kAllAxes) == 3 || lasting(kTwoAxes) >= 2 || lasting(one) >= 1;
}

bool Plausibility::gyro_stuck(std::int64_t time) const {
  const bool each = std::ranges::all_of(stuck_axes_, [](bool stuck) { return stuck; });
  return each || (moves() && all_last(rate_, time, kInMotion));
}

Plausibility::Name Plausibility::name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kFrozen:
      return {"withheld.frozen",
              "the IMU repeats one sample: its values are those of before; its samples are withheld"};
    case Verdict::kStuckAccelerometer:
      return {"withheld.stuck_accelerometer",
              "the IMU's accelerometer is stuck: an axis shows the same value all the time; its samples are withheld"};
    case Verdict::kStuckGyro:
      return {"withheld.stuck_gyro",
              "the IMU's gyro is stuck or at the end of its range: its axes show the same rates all the time; its "
              "samples are withheld"};
    case Verdict::kNotGravity:
      return {"withheld.not_gravity",
              "the IMU's mean acceleration is not gravity: wrong range or unit, or a dead axis; its samples are "
              "withheld"};
    case Verdict::kGood:
      break;
  }
  return {};
}

}  // namespace curbstone::imu
