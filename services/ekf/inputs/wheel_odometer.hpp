#pragma once

#include <array>
#include <optional>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/base/samples.hpp"
#include "services/ekf/inputs/stamp_jitter.hpp"

namespace curbstone::ekf::inputs {

/// Mean speeds of both wheels over an interval, with the configured radius.
struct WheelInterval {
  std::int64_t begin = 0;            ///< us
  std::int64_t end = 0;              ///< us
  std::array<double, 2> speed = {};  ///< m/s, left and right
  double jitter = 0.0;               ///< 1 sigma of the duration's error as a share of it, in addition to stamp_noise
  [[nodiscard]] double duration() const { return base::seconds_between(begin, end); }
  [[nodiscard]] double mean_speed() const { return 0.5 * (speed[0] + speed[1]); }
};

/// 1 sigma of a wheel's mean speed over the interval, m/s: slip, stamp jitter, quantisation.
[[nodiscard]] double wheel_sigma(const base::WheelsConfig& config, const WheelInterval& interval, double wheel_radius,
                                 std::size_t wheel);

/// Converts wheel angles to speeds: differences of angles over differences of stamps, over intervals long enough that
/// stamp jitter and quantisation do not matter (a stamp error is divided by the interval). Where the stamps jitter by
/// more than that (StampJitter), intervals are longer. Intervals are adjacent and do not overlap, so their sum is the
/// travel. A first sample that does not fit the next two is ignored: the period of a sensor that has just been started
/// is often not regular yet.
class WheelOdometer {
 public:
  WheelOdometer(const base::WheelsConfig& config, double wheel_radius, double max_gap)
      : config_(config), radius_(wheel_radius), max_gap_(max_gap), jitter_(config, wheel_radius) {}

  enum class Step {
    kFirst,     ///< an interval begins
    kOpen,      ///< the interval continues
    kInterval,  ///< interval() is complete, the next one begins
    kGap,       ///< samples were missing for too long; a new interval begins
    kNonsense,  ///< faster than any wheel: the counter restarted. A new interval begins
  };
  Step add(const base::WheelSample& sample);
  [[nodiscard]] const WheelInterval& interval() const { return interval_; }
  /// From the previous sample to the newest; nothing after kFirst, kGap and kNonsense.
  [[nodiscard]] const std::optional<WheelInterval>& newest() const { return newest_; }
  void reset();

 private:
  [[nodiscard]] bool fits_first(const base::WheelSample& third) const;
  [[nodiscard]] WheelInterval between(const base::WheelSample& a, const base::WheelSample& b) const;
  [[nodiscard]] double min_duration() const;

  base::WheelsConfig config_;
  double radius_;   // m
  double max_gap_;  // s
  StampJitter jitter_;
  std::optional<base::WheelSample> begin_;
  base::WheelSample last_;
  WheelInterval interval_;
  std::optional<WheelInterval> newest_;
  int samples_ = 0;  // since the first one, up to kChecked
  static constexpr int kChecked = 3;
};

}  // namespace curbstone::ekf::inputs
