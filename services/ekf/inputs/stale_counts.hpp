#pragma once

#include <array>
#include <optional>

#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::inputs {

/// Detects samples whose angle is an earlier one, sent again: a drive or a gateway may renew its counts less often than
/// they are requested. If used, they show a wheel that stops dead and then leaps, ten times a second. The travel is in
/// the next sample that is not old.
///
/// An angle is old if it has not changed since the last sample that was used, and
/// - the wheel turned so fast that it cannot have stopped since, or
/// - its angle has been renewed at one period three times in a row, and that period has not passed yet. This holds at
///   any speed, and ends where the wheel stops: after one period without a change the angle is accepted.
///
/// Wheels whose angles change from sample to sample are never old. Pure; one thread.
class StaleCounts {
 public:
  /// Whether the sample is old. A sample that is not newer than the one before is not judged.
  [[nodiscard]] bool is_stale(const base::WheelSample& sample);

 private:
  /// How often a wheel's angle changes, whether or not the samples in between are used.
  struct Renewal {
    std::int64_t changed = 0;  // us, time of the angle's latest change
    double angle = 0.0;        // rad
    bool repeated = false;     // the angle has been sent again since then
    double gap = 0.0;          // s between the last two changes with a repeated angle in between; 0: none yet
    int alike = 0;             // consecutive gaps that agree
    int fresh = 0;             // consecutive changes without a repeated angle in between
    double period = 0.0;       // s, renewal period of the angle; 0: changes from sample to sample
    void add(std::int64_t utime, double new_angle);
  };

  std::optional<base::WheelSample> used_;  // latest sample that was not old
  std::array<double, 2> rate_ = {};        // rad/s, up to that sample
  std::int64_t newest_ = 0;                // us
  std::array<Renewal, 2> renewals_;
};

}  // namespace curbstone::ekf::inputs
