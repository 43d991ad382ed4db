#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>

#include "common/geometry/geometry.hpp"
#include "common/resend/resend_client.hpp"
#include "services/mapper/scan/deskew.hpp"

namespace curbstone::mapper::scan {

/// What the mapper takes from one ODOMETRY message.
struct OdometrySample {
  std::int64_t utime = 0;  ///< us
  Pose T_odom_base = Pose::Identity();
  bool usable = true;  ///< the filter says that it is initialised
  bool stationary = false;
  bool turn_confirmed = true;  ///< wheels and gyro have shown the same turn over the last second
  bool with_gyro = true;       ///< false: it coasts on the wheels, which turn it by tenths of a degree a second
};

/// A bounded stretch of odometry in order of time, for poses at any time in between, and kLead beyond: in so short a
/// time a vehicle's motion hardly changes, and a scan need not wait for the next sample. Pure; one thread.
class OdometryHistory {
 public:
  static constexpr std::int64_t kLead = 20'000;          ///< us: at 2 m/s^2, 0.4 mm
  static constexpr std::size_t kCapacity = 8000;         ///< 80 s at 100 Hz
  static constexpr std::int64_t kMaxGap = 200'000;       ///< us between samples that may be interpolated over
  static constexpr std::int64_t kClockJump = 1'000'000;  ///< us backwards that is a new clock, not a late message,
  static constexpr std::int64_t kSetBack = 100'000;      ///< or this, of kAgreeing in a row that go on from each other
  static constexpr int kAgreeing = 5;
  static constexpr double kGapSteps = 1.6;

  enum class Added { kYes, kLate, kClockJump };
  /// Late samples are left out. When the clock jumps back, what was known before is forgotten.
  Added add(const OdometrySample& sample);

  /// Another listener had all odometry until `utime`, us: what is missing from there to the first sample is a gap, too.
  void begin_at(std::int64_t utime) { begin_ = utime; }
  /// The first place that ends later than `from`, us, and at which samples are missing: a step that is longer than
  /// kGapSteps of those beside it. At most ResendClient::kMostMissing long.
  [[nodiscard]] std::optional<MissingMessages> gap(std::int64_t from) const;
  /// Puts in a sample that belongs before the newest one. False if there is one of this time, or no room.
  bool fill(const OdometrySample& sample);

  /// Whether odometry has come to kLead before `utime`, usable or not: nothing more need be waited for.
  [[nodiscard]] bool reaches(std::int64_t utime) const {
    return !samples_.empty() && samples_.back().utime + kLead >= utime;
  }
  /// From now on only what was known when odometry first reached `utime` is looked at: what is said does not depend on
  /// whether more was there in time.
  void look_from(std::int64_t utime) { horizon_ = utime; }
  /// Whether `from`..`to` lies between usable samples without a gap, or no farther than kLead beyond the last. A step
  /// of the host's clock is no gap.
  [[nodiscard]] bool covers(std::int64_t from, std::int64_t to) const;
  /// Pose at a covered time: linear in position, spherical-linear in attitude; beyond the last sample the motion of the
  /// last few goes on.
  [[nodiscard]] Pose at(std::int64_t utime) const;
  /// Whether the filter says, all through a covered stretch, that the vehicle stands.
  [[nodiscard]] bool stationary(std::int64_t from, std::int64_t to) const;
  /// Whether wheels and gyro showed the same turn, all through a covered stretch.
  [[nodiscard]] bool turn_confirmed(std::int64_t from, std::int64_t to) const;
  /// Whether a gyro showed how the vehicle turned, all through a covered stretch.
  [[nodiscard]] bool with_gyro(std::int64_t from, std::int64_t to) const;
  /// Forgets what is not needed for times from `utime` on.
  void forget_before(std::int64_t utime);

 private:
  /// Index of the first sample at or after `utime`; size() if there is none.
  [[nodiscard]] std::size_t lower_bound(std::int64_t utime) const;
  /// Whether every sample of a covered stretch says so.
  [[nodiscard]] bool all(std::int64_t from, std::int64_t to, bool OdometrySample::*says) const;
  /// How many samples may be looked at.
  [[nodiscard]] std::size_t num_known() const;
  /// Whether in the gap behind sample `i` the host's clock was set forward: the stamps jump, and the vehicle does not.
  [[nodiscard]] bool is_clock_step(std::size_t i, std::size_t known) const;
  [[nodiscard]] Pose beyond(std::size_t last, std::int64_t utime) const;
  std::deque<OdometrySample> samples_;
  std::int64_t late_ = 0;  // us, the last sample that was, since one that was not
  int agreeing_ = 0;       // of these, in a row
  std::int64_t begin_ = 0;
  std::int64_t horizon_ = std::numeric_limits<std::int64_t>::max();
};

/// Motion from `from` to `to`, which must be covered.
[[nodiscard]] SweepMotion sweep_from(const OdometryHistory& odometry, std::int64_t from, std::int64_t to);

}  // namespace curbstone::mapper::scan
