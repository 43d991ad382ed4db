#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>

#include "common/geometry/geometry.hpp"
#include "common/resend/resend_client.hpp"
#include "services/mapper/scan/deskew.hpp"

namespace curbstone::mapper::scan {

/// The fields of an ODOMETRY message that the mapper uses.
struct OdometrySample {
  std::int64_t utime = 0;  ///< us
  Pose T_odom_base = Pose::Identity();
  bool usable = true;  ///< the odometry filter reports that it is initialised
  bool stationary = false;
  bool turn_confirmed = true;  ///< wheels and gyro agreed on the turn over the last second
  bool with_gyro = true;       ///< false: dead reckoning on wheels, whose yaw drifts by tenths of a degree a second
};

/// A bounded history of odometry in order of time. Gives the pose at any time in between, and up to kLead beyond the
/// newest sample: a vehicle's motion hardly changes in so short a time, and a scan need not wait for the next sample.
/// Of two filters that publish at the same time the first is used: the other one began elsewhere, so its poses do not
/// continue these. Pure; one thread.
class OdometryHistory {
 public:
  static constexpr std::int64_t kLead = 20'000;        ///< us: an error of 0.4 mm at 2 m/s^2
  static constexpr std::size_t kCapacity = 8000;       ///< 80 s at 100 Hz
  static constexpr std::int64_t kMaxGap = 200'000;     ///< us: largest interval that is interpolated over
  static constexpr std::int64_t kSetBack = 100'000;    ///< us backwards: the clock was set, if kAgreeing samples in a
  static constexpr int kAgreeing = 5;                  ///< row continue each other. From kFarBack on, which a log that
  static constexpr std::int64_t kFarBack = 1'000'000;  ///< is played into the bus may be, kAgreeingFarBack, for these
  static constexpr int kAgreeingFarBack = 20;          ///< come in bursts
  static constexpr std::int64_t kMaxClockStep = 1'000'000;  ///< us ahead
  static constexpr double kGapSteps = 1.6;
  static constexpr std::int64_t kReportedFor = 1'000'000;  ///< us

  enum class Added { kYes, kLate, kClockJump, kElsewhere };
  /// Adds a sample. Late samples are dropped. When the clock was set back, the earlier history is discarded, and the
  /// samples that told are the new one. A sample elsewhere than the motion leads is of another filter, and is dropped
  /// unless such samples come for kMaxGap without one of the first: the filter has leapt, and they are all added.
  Added add(const OdometrySample& sample);

  /// Whether two filters have published within the last kReportedFor.
  [[nodiscard]] bool has_second_filter() const {
    return second_filter_ != 0 && newest() - second_filter_ < kReportedFor;
  }

  /// Another listener had all odometry until `utime`, us: samples missing between there and the first sample are a gap,
  /// too.
  void begin_at(std::int64_t utime) { begin_ = utime; }
  /// The first gap that ends later than `from`, us: an interval longer than kGapSteps of the neighbouring intervals. At
  /// most ResendClient::kMaxMissing long.
  [[nodiscard]] std::optional<MissingMessages> gap(std::int64_t from) const;
  /// Inserts a sample before the newest one. False if there is one with the same stamp, or no room, or the sample lies
  /// elsewhere than the motion before it leads.
  bool fill(const OdometrySample& sample);

  /// us, stamp of the newest sample; 0: there is none.
  [[nodiscard]] std::int64_t newest() const { return samples_.empty() ? 0 : samples_.back().utime; }
  /// Whether odometry extends to kLead before `utime`, usable or not: there is nothing more to wait for.
  [[nodiscard]] bool reaches(std::int64_t utime) const {
    return !samples_.empty() && samples_.back().utime + kLead >= utime;
  }
  /// Restricts all queries from now on to the samples that were there when odometry first reached `utime`. The answers
  /// then do not depend on how much more has arrived.
  void set_horizon(std::int64_t utime) { horizon_ = utime; }
  /// Whether `from`..`to` lies between usable samples without a gap, or at most kLead beyond the last. A step of the
  /// host's clock is not a gap.
  [[nodiscard]] bool covers(std::int64_t from, std::int64_t to) const;
  /// The pose at a covered time: position is interpolated linearly, attitude by slerp; beyond the last sample the
  /// motion of the last few is extrapolated.
  [[nodiscard]] Pose at(std::int64_t utime) const;
  /// The first sample after `utime`, usable, that comes within kMaxGap; null if there is none.
  [[nodiscard]] const OdometrySample* soon_after(std::int64_t utime) const;
  /// Whether the filter reports a standstill throughout a covered interval.
  [[nodiscard]] bool stationary(std::int64_t from, std::int64_t to) const;
  /// Whether wheels and gyro agreed on the turn throughout a covered interval.
  [[nodiscard]] bool turn_confirmed(std::int64_t from, std::int64_t to) const;
  /// Whether a gyro measured the turn throughout a covered interval.
  [[nodiscard]] bool with_gyro(std::int64_t from, std::int64_t to) const;
  /// us, the longest interval between two samples of which the later one lies after `from`; 0: there is none.
  [[nodiscard]] std::int64_t longest_step(std::int64_t from) const;
  /// Drops what is not needed for times from `utime` on. Nothing if that is later than the newest sample: then it is a
  /// time of the clock before this one.
  void forget_before(std::int64_t utime);

 private:
  /// Index of the first sample at or after `utime`; size() if there is none.
  [[nodiscard]] std::size_t lower_bound(std::int64_t utime) const;
  /// Whether the flag `says` is set in every sample of a covered interval.
  [[nodiscard]] bool all(std::int64_t from, std::int64_t to, bool OdometrySample::*says) const;
  /// Number of samples that queries may use.
  [[nodiscard]] std::size_t num_known() const;
  /// Whether the host's clock was set forward in the gap after sample `i`: the stamps jump, and the vehicle does not.
  [[nodiscard]] bool is_clock_step(std::size_t i, std::size_t known) const;
  [[nodiscard]] Pose beyond(std::size_t last, std::int64_t utime) const;
  Added add_late(const OdometrySample& sample);
  /// Whether the motion up to sample `last` leads to this later one. After more than kMaxGap it counts as leading
  /// there.
  [[nodiscard]] bool leads_to(std::size_t last, const OdometrySample& sample) const;
  void append(const OdometrySample& sample);
  void give_up_second_filter(std::int64_t utime);
  std::deque<OdometrySample> samples_;
  std::deque<OdometrySample> late_;       // the latest, in a row, that continue each other; none since one was in time
  std::deque<OdometrySample> elsewhere_;  // the latest, in a row, that continue each other in another frame
  std::int64_t other_dropped_ = 0;        // us, when samples of another frame were last given up; 0: never
  std::int64_t second_filter_ = 0;        // us, the same, if it was not the first time within kReportedFor
  std::int64_t begin_ = 0;
  std::int64_t horizon_ = std::numeric_limits<std::int64_t>::max();
};

/// Motion from `from` to `to`, us; the interval must be covered.
[[nodiscard]] SweepMotion sweep_from(const OdometryHistory& odometry, std::int64_t from, std::int64_t to);

}  // namespace curbstone::mapper::scan
