#pragma once

#include <array>
#include <optional>

#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::inputs {

/// Finds the samples in which an angle is an earlier one, sent again: a drive or a gateway may renew its counts more
/// rarely than it is asked for them. Believed, they show a wheel that stops dead and then leaps, ten times a second.
/// The travel is in the next sample that is not old.
///
/// An angle is old if it has not changed since the last sample that was used, and
/// - the wheel turned so fast that it cannot have stopped since, or
/// - its angles have come renewed at one period, three times in a row, and that is not over yet. This holds at any
///   speed, and ends where the wheel stops: after one period without a change the angle is believed.
///
/// Wheels whose angles change from sample to sample are never old. Pure; one thread.
class OldCounts {
 public:
  /// Whether the sample says nothing new. One that is not newer than the sample before is not judged.
  [[nodiscard]] bool is_old(const base::WheelSample& sample);

 private:
  /// How often a wheel's angle changes, whether or not the samples between are used.
  struct Renewal {
    std::int64_t changed = 0;  // us, when the angle last did
    double angle = 0.0;        // rad
    bool repeated = false;     // since then it has been sent again
    double gap = 0.0;          // s, between the last two changes, with a repeated angle between; 0: none was
    int alike = 0;             // gaps in a row that agree
    int fresh = 0;             // changes in a row without a repeated angle between
    double period = 0.0;       // s, at which the angles come renewed; 0: from sample to sample
    void add(std::int64_t utime, double new_angle);
  };

  std::optional<base::WheelSample> used_;  // the last one that was not old
  std::array<double, 2> rate_ = {};        // rad/s, up to it
  std::int64_t newest_ = 0;                // us
  std::array<Renewal, 2> renewals_;
};

}  // namespace curbstone::ekf::inputs
