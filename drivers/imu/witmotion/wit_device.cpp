#include "drivers/imu/witmotion/wit_device.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

#include "common/bytes/little_endian.hpp"
#include "common/geometry/gravity.hpp"

namespace curbstone::imu::witmotion {

namespace {

constexpr double kAcceleration = 16.0 / 32768 * kGravity;                 // m/s^2
constexpr double kAngularRate = 2000.0 / 32768 * std::numbers::pi / 180;  // rad/s
constexpr int kFullScale = 32767;
constexpr double kRateSlack = 0.2;
constexpr std::int64_t kRatePatience = 3'000'000;  // us
constexpr int kUsual = 3;                          // consecutive groups with fewer frames that are accepted as complete

constexpr unsigned bit(WitId id) {
  return 1u << (static_cast<unsigned>(id) - 0x50u);
}
constexpr unsigned kInertia = bit(WitId::kAcceleration) | bit(WitId::kAngularRate);
constexpr unsigned kGrouped =
    kInertia | bit(WitId::kTime) | bit(WitId::kAngle) | bit(WitId::kMagnetic) | bit(WitId::kQuaternion);

std::array<double, 3> vector(const WitFrame& frame, double scale) {
  return {scale * frame.word(0), scale * frame.word(1), scale * frame.word(2)};
}

bool clips(const WitFrame& frame, std::size_t axis) {
  return std::abs(frame.word(axis)) >= kFullScale;
}

/// w first, as is usual; the maker does not document the order.
std::optional<std::array<double, 4>> quaternion(const WitFrame& frame) {
  std::array<double, 4> q{};
  double norm = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    q[i] = frame.word(i) / 32768.0;
    norm += q[i] * q[i];
  }
  norm = std::sqrt(norm);
  if (std::abs(norm - 1) > 0.01) return {};
  for (double& component : q) component /= norm;
  return q;
}

/// Ticks of 0.1 ms since midnight, which wrap like those of some Xsens devices.
std::optional<std::uint32_t> time_of_day(const WitFrame& frame) {
  const std::uint32_t hour = frame.data[3], minute = frame.data[4], second = frame.data[5];
  const std::uint32_t ms = read_little_endian<std::uint16_t>(frame.data.subspan(6));
  if (hour > 23 || minute > 59 || second > 59 || ms > 999) return {};
  return (((hour * 60 + minute) * 60 + second) * 1000 + ms) * 10;
}

}  // namespace

WitDevice::WitDevice(const device::DeviceSettings& settings, Send send)
    : settings_(settings),
      configurator_({settings.configure, settings.rate, settings.orientation, settings.patience}, std::move(send)) {}

void WitDevice::on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes, const Handler& handler) {
  parser_.parse(bytes, [&](const WitFrame& frame) { on_frame(now, frame, handler); });
}

void WitDevice::on_frame(std::int64_t now, const WitFrame& frame, const Handler& handler) {
  if (frame.id > 0x5A || (kGrouped & 1u << (frame.id - 0x50u)) == 0) return counters_.add("skipped.frames");
  if (group_.ids != 0 && frame.id <= group_.last) end_group(now, handler);
  if (group_.ids == 0) group_.begun = now;
  group_.ended = now;
  group_.broken = group_.broken || (frame.after_gap && group_.ids != 0);
  group_.ids |= 1u << (frame.id - 0x50u);
  group_.last = frame.id;
  ++group_.frames;
  take(frame);
  if (expected_ != 0 && (group_.ids & expected_) == expected_ && !group_.done && !group_.broken) use_group(handler);
}

void WitDevice::take(const WitFrame& frame) {
  switch (static_cast<WitId>(frame.id)) {
    case WitId::kTime:
      group_.ticks = time_of_day(frame);
      if (!group_.ticks) counters_.add("refused.range");
      group_.broken = group_.broken || !group_.ticks;
      break;
    case WitId::kAcceleration:
      group_.sample.acceleration = vector(frame, kAcceleration);
      group_.sample.temperature = frame.word(3) / 100.0;
      group_.sample.force_clips = clips(frame, 0) || clips(frame, 1) || clips(frame, 2);
      break;
    case WitId::kAngularRate:
      group_.sample.angular_rate = vector(frame, kAngularRate);
      for (std::size_t i = 0; i < 3; ++i) group_.sample.rate_clips[i] = clips(frame, i);
      break;
    case WitId::kQuaternion:
      group_.sample.orientation = quaternion(frame);
      if (!group_.sample.orientation) counters_.add("refused.range");
      break;
    default:
      break;
  }
}

/// Ends the group when another one begins. The first group defines which frames a complete one has.
void WitDevice::end_group(std::int64_t now, const Handler& handler) {
  const bool whole = (group_.ids & expected_) == expected_ && !group_.broken;
  if (whole && !group_.done) use_group(handler);
  if (!whole && !group_.done) counters_.add("refused.group");
  if (whole) {
    expected_ = group_.ids;
    fewer_times_ = 0;
  } else if (!group_.broken) {
    fewer_times_ = group_.ids == fewer_ ? fewer_times_ + 1 : 1;
    fewer_ = group_.ids;
    if (fewer_times_ >= kUsual) expected_ = fewer_;
  }
  group_ = {};
  group_.begun = now;
}

void WitDevice::use_group(const Handler& handler) {
  group_.done = true;
  if ((group_.ids & kInertia) != kInertia) return counters_.add("skipped.incomplete");
  const std::int64_t bits = group_.frames * static_cast<std::int64_t>(WitFrame::kSize) * 10;
  group_.sample.received = settings_.uart ? group_.ended - bits * 1'000'000 / settings_.baud : group_.begun;
  if (!judge_time()) return;
  if (group_.ticks) configurator_.on_usable_sample();
  watch_rate(group_.ended);
  handler(group_.sample);
}

/// Returns false if the group's time is wrong; counts the cause.
bool WitDevice::judge_time() {
  if (!group_.ticks) return true;
  using Verdict = device::SampleTime::Verdict;
  const auto at = sample_time_.next(*group_.ticks, group_.sample.received, {});
  if (at.verdict == Verdict::kRepeated || at.verdict == Verdict::kRefused) {
    counters_.add(at.verdict == Verdict::kRepeated ? "refused.repeated" : "refused.time");
    return false;
  }
  group_.sample.time = at.time;
  group_.sample.missing = at.missing;
  group_.sample.restarted = at.verdict == Verdict::kRestarted;
  if (at.missing > 0) counters_.add("lost.packets", at.missing);
  if (group_.sample.restarted) configurator_.start(group_.sample.received);  // it was off, and has lost its set-up
  return true;
}

/// Another program has set another rate, or the device has lost its rate without losing power: the set-up is repeated.
void WitDevice::watch_rate(std::int64_t now) {
  const double interval = sample_time_.interval();
  if (!settings_.configure || !group_.ticks || interval <= 0) return;
  const double rate = 1e6 / interval;
  if (std::abs(rate - configurator_.rate()) <= kRateSlack * configurator_.rate()) {
    wrong_rate_since_ = 0;
    rate_fault_.clear();
  } else if (wrong_rate_since_ == 0 || now < wrong_rate_since_) {
    wrong_rate_since_ = now;
  } else if (now - wrong_rate_since_ > kRatePatience) {
    wrong_rate_since_ = now;
    counters_.add("device.reconfigured");
    configurator_.start(now);
    rate_fault_ =
        fmt::format("the IMU sends at {:.0f} Hz, {} Hz was asked for: set by another program, or its line is full",
                    rate, configurator_.rate());
  }
}

void WitDevice::on_link(std::int64_t now, link::LinkState state) {
  parser_.reset();
  group_ = {};
  if (state == link::LinkState::kDown) return;
  sample_time_ = {};  // another device may have been plugged in
  configurator_.start(now);
}

Counters WitDevice::counters() const {
  Counters all = counters_;
  for (const Counters* more : {&parser_.counters(), &configurator_.counters()}) all.add(*more);
  return all;
}

}  // namespace curbstone::imu::witmotion
