#include "services/mapper/scan/lidar_clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace curbstone::mapper::scan {
namespace {

constexpr std::int64_t kMaxLost = 100'000;               // a larger step of the sequence numbers is a restart
constexpr std::int64_t kMaxPacketInterval = 200'000;     // us: a revolution in one
constexpr std::int64_t kRestartBack = 1'000'000;         // us: a lower number with a stamp so much earlier is not late
constexpr std::int64_t kNoCorrection = 20'000;           // us: what remains of two steps that cancel
constexpr std::int64_t kMinClockStep = 10'000;           // us
constexpr std::int64_t kMaxRestart = 3'600'000'000;      // us
constexpr std::int64_t kLatest = std::int64_t{1} << 60;  // us: no stamp, and far from an overflow
constexpr int kMaxMisfits = 20;                          // packets
constexpr int kDiffering = 100;                          // times in a row: a second of odometry
constexpr double kFarOff = 500'000;                      // us
constexpr int kSteady = 400;     // times in a row: 4 s; what is sent again after a loss is old for less
constexpr int kFollowing = 750;  // packets in a row
constexpr double kSmoothing = 1.0 / 128;

/// Whether a step is left as it is, unless the next packet ends it.
bool is_small(std::int64_t step) {
  return step >= -LidarClock::kStepBack && step <= LidarClock::kStepAhead;
}

void pass(const lidar_points_t& packet, std::int64_t correction, const LidarClock::Handler& handler) {
  if (correction == 0) return handler(packet);
  lidar_points_t corrected = packet;
  corrected.utime += correction;
  handler(corrected);
}

}  // namespace

void LidarClock::add(const lidar_points_t& packet, std::int64_t odometry, const Handler& handler) {
  if (packet.utime <= 0 || packet.utime > kLatest || is_late(packet)) return pass(packet, correction_, handler);
  const Heard now{packet.packet, packet.utime + correction_, odometry};
  if (step_) return hold(packet, now, handler);
  if (last_ && last_->odometry != 0 && odometry != 0) {
    const std::int64_t by = now.utime - expected_after(*last_, now);
    if (std::abs(by) > (interval_ == 0 ? kMaxPacketInterval : std::max(kMinClockStep, 2 * interval_))) {
      step_ = Step{by, std::min(kAgree, std::abs(by) / 2), now.utime, now};
      return hold(packet, now, handler);
    }
  }
  follow(now);
  if (is_followed_by_odometry(now)) set_right();
  pass(packet, correction_, handler);
}

bool LidarClock::is_late(const lidar_points_t& packet) const {
  if (!last_) return false;
  const std::int64_t back = last_->utime - (packet.utime + correction_);
  return packet.packet <= last_->number && back >= 0 && back < kRestartBack;
}

/// us, the packet's stamp in the clock of an earlier one. After a restart of the driver the sequence numbers do not
/// show the time in between; odometry does.
std::int64_t LidarClock::expected_after(const Heard& before, const Heard& now) const {
  const std::int64_t packets = std::int64_t{now.number} - before.number;
  if (packets > 0 && packets <= kMaxLost) return before.utime + packets * interval_;
  return before.utime + std::clamp<std::int64_t>(now.odometry - before.odometry, 0, kMaxRestart);
}

void LidarClock::follow(const Heard& now) {
  if (last_ && std::int64_t{now.number} - last_->number == 1) {
    const std::int64_t took = now.utime - last_->utime;
    const std::int64_t longest = interval_ == 0 ? kMaxPacketInterval : 4 * interval_;  // a longer one is a pause
    if (took > 0 && took <= longest) interval_ = interval_ == 0 ? took : (15 * interval_ + took) / 16;
  }
  if (!last_ || now.odometry > last_->odometry) compare_with_odometry(now);
  last_ = now;
}

void LidarClock::compare_with_odometry(const Heard& now) {
  if (now.odometry == 0) return;
  const auto ahead = static_cast<double>(now.utime - now.odometry);
  const bool agrees = ahead_ && std::abs(ahead - *ahead_) < kAgree;
  differing_ = agrees ? 0 : differing_ + 1;
  agreeing_ = agrees ? agreeing_ + 1 : 0;
  if (!ahead_ || differing_ > kDiffering) ahead_ = ahead;
  if (agrees) *ahead_ += kSmoothing * (ahead - *ahead_);
}

/// Whether odometry's stamps have agreed for long with those of the LiDAR as they come: its clock was set, too.
bool LidarClock::is_followed_by_odometry(const Heard& now) {
  if (correction_ == 0 || !ahead_) return false;
  const auto ahead = static_cast<double>(now.utime - correction_ - now.odometry);
  const bool agrees = std::abs(ahead - *ahead_) < kAgree;
  followed_ = agrees ? followed_ + 1 : 0;
  return followed_ >= kFollowing;
}

void LidarClock::set_right() {
  last_->utime -= std::exchange(correction_, 0);
  followed_ = 0;
}

/// Takes a packet after the step, its first one included.
void LidarClock::hold(const lidar_points_t& packet, const Heard& now, const Handler& handler) {
  const bool fits_held = !held_.empty() && std::abs(now.utime - expected_after(step_->newest, now)) <= step_->tolerance;
  if (std::abs(now.utime - expected_after(*last_, now)) < step_->tolerance) {  // the old clock goes on
    if (fits_held) return end_pause(packet, now, handler);
    counters_.add("lidar.stamps_corrected", static_cast<std::int64_t>(held_.size()));
    end_step(correction_ - step_->by, handler);
    follow(now);
    return pass(packet, correction_, handler);
  }
  if (!held_.empty() && !fits_held) {
    counters_.add("refused.lidar_stamp");
    if (++step_->misfits >= kMaxMisfits) end_step(correction_, handler);
    return;
  }
  held_.push_back(packet);
  step_->newest = now;
  step_->misfits = 0;
  switch (verdict()) {
    case Verdict::kOpen:
      return;
    case Verdict::kLidarAlone:
      counters_.add("lidar.clock_corrections");
      correction_ -= step_->by;
      if (std::abs(correction_) < kNoCorrection) correction_ = 0;
      break;
    case Verdict::kAsTheyAre:
      if (!is_small(step_->by)) ahead_.reset();
      break;
  }
  end_step(correction_, handler);
}

/// The old clock and that of the held packets are the same: the driver started again after a pause of all sensors, and
/// odometry, which alone tells how long it was, came later.
void LidarClock::end_pause(const lidar_points_t& packet, const Heard& now, const Handler& handler) {
  end_step(correction_, handler);
  follow(now);
  pass(packet, correction_, handler);
}

LidarClock::Verdict LidarClock::verdict() const {
  if (held_.size() < 2) return Verdict::kOpen;  // a damaged stamp has no second
  if (is_small(step_->by)) return Verdict::kAsTheyAre;
  const std::int64_t held_for = step_->newest.utime - step_->began;
  const std::int64_t odometry = step_->newest.odometry;
  const double since = static_cast<double>(step_->newest.utime - odometry) - ahead_.value_or(0);
  if (std::abs(since) < kAgree) return Verdict::kAsTheyAre;
  const bool goes_on = odometry > last_->utime + kProof && std::abs(since - static_cast<double>(step_->by)) < kAgree;
  if (goes_on && held_for >= (step_->by < 0 ? kHoldBack : kHoldAhead)) return Verdict::kLidarAlone;
  return held_for >= kMaxHold || held_.size() >= kMaxHeld ? Verdict::kAsTheyAre : Verdict::kOpen;
}

/// Passes on what is held, `correction` us, later than it was stamped.
void LidarClock::end_step(std::int64_t correction, const Handler& handler) {
  const std::deque<lidar_points_t> held = std::exchange(held_, {});
  last_ = step_->newest;
  last_->utime = held.back().utime + correction;
  step_.reset();
  for (const lidar_points_t& packet : held) pass(packet, correction, handler);
}

void LidarClock::release(const Handler& handler) {
  if (step_) end_step(correction_, handler);
}

std::int64_t LidarClock::corrected(std::int64_t utime) const {
  return std::min(utime, kLatest) + correction_ - (step_ ? step_->by : 0);
}

void LidarClock::add_faults(std::vector<std::string>& faults) const {
  if (ahead_ && std::abs(*ahead_) > kFarOff && agreeing_ >= kSteady)
    faults.push_back(
        fmt::format("LiDAR: its stamps are {:.1f} s {} odometry's, and its scans are used without odometry: is its "
                    "clock right (GPS, PTP), or that of its host?",
                    std::abs(*ahead_) * 1e-6, *ahead_ > 0 ? "ahead of" : "behind"));
  if (correction_ == 0) return;
  faults.push_back(fmt::format(
      "LiDAR: its clock was set {:.2f} s {}, and odometry's was not: its stamps are corrected by that until "
      "it is set right. Does it lose GPS or PTP, or do two programs set its host's clock?",
      std::abs(static_cast<double>(correction_)) * 1e-6, correction_ > 0 ? "back" : "ahead"));
}

}  // namespace curbstone::mapper::scan
