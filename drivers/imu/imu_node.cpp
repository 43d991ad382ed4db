#include "drivers/imu/imu_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "common/bus/levels.hpp"
#include "common/bus/sequence_number.hpp"
#include "common/time/microseconds.hpp"
#include "drivers/imu/auto_device.hpp"
#include "drivers/imu/witmotion/wit_device.hpp"
#include "drivers/imu/xsens/xsens_device.hpp"

namespace curbstone::imu {

namespace {

constexpr std::int64_t kWatchPeriod = 1'000'000;  // us
constexpr std::int64_t kSetBack = 100'000;        // us: after a smaller step samples wait for the host's clock

constexpr std::array<std::int32_t, 3> kStuckBits = {imu_t::GYRO_X_STUCK, imu_t::GYRO_Y_STUCK, imu_t::GYRO_Z_STUCK};
constexpr std::array kStuckCounters = {"stuck.gyro_x", "stuck.gyro_y", "stuck.gyro_z"};

std::unique_ptr<device::ImuDevice> make_device(const ImuConfig& config, ImuNode::Send send) {
  const device::DeviceSettings settings{
      .configure = config.configure,
      .rate = config.rate,
      .orientation = config.orientation,
      .patience = microseconds(config.silence),
      .baud = config.baud,
      .uart = config.line == Line::kUart,
  };
  switch (config.model) {
    case Model::kXsens:
      return std::make_unique<xsens::XsensDevice>(settings, std::move(send));
    case Model::kWitMotion:
      return std::make_unique<witmotion::WitDevice>(settings, std::move(send));
    case Model::kAuto:
      break;
  }
  return std::make_unique<AutoDevice>(settings, std::move(send));
}

}  // namespace

ImuNode::ImuNode(const ImuConfig& config, Publisher& bus, Send send)
    : config_(config), bus_(bus), device_(make_device(config, std::move(send))), receipt_stamps_(config.rate) {}

void ImuNode::on_bytes(std::int64_t receive_utime, std::span<const std::uint8_t> bytes) {
  counters_.add("bytes", static_cast<std::int64_t>(bytes.size()));
  if (receive_utime < received_ - kSetBack) on_clock_set_back(receive_utime);
  received_ = receive_utime;
  device_->on_bytes(receive_utime, bytes, [this](const device::ImuSample& sample) { on_sample(sample); });
  stamp_untimed(receive_utime);
  count_refusals(receive_utime);
}

/// Updates the refusals from the device's counters since the last call.
void ImuNode::count_refusals(std::int64_t now) {
  Counters counters = device_->counters();
  std::int64_t refused = 0;
  for (const auto& [name, value] : counters.values()) {
    if (!name.starts_with("refused.")) continue;
    for (std::int64_t k = counted_[name]; k < value; ++k, ++refused) refusals_.refused(now, name);
  }
  const std::int64_t frames = counters["frames"] - counted_["frames"];
  for (std::int64_t k = refused; k < frames; ++k) refusals_.used(now);
  counted_ = std::move(counters);
}

void ImuNode::on_sample(const device::ImuSample& sample) {
  if (sample.restarted) {
    restart_clock();
    restarts_.add(sample.received);
  }
  if (!sample.time) return untimed_.push_back(sample);
  stamp_untimed(sample.received);
  use(sample, to_host(*sample.time, sample.received));
}

/// Stamps the samples of one read that have no device time.
void ImuNode::stamp_untimed(std::int64_t receive_utime) {
  std::vector<std::int64_t> times;
  for (const device::ImuSample& sample : untimed_) times.push_back(sample.received);
  receipt_stamps_.spread(receive_utime, last_utime_, times);
  for (std::size_t i = 0; i < untimed_.size(); ++i) {
    counters_.add("stamped_on_receipt");
    use(untimed_[i], {times[i], 0});
  }
  untimed_.clear();
}

void ImuNode::use(const device::ImuSample& sample, HostTime at) {
  sequence_ = next_sequence_number(sequence_, std::int64_t{1} + sample.missing);
  last_sample_ = sample.received;
  start_.move_earlier(at.earlier);

  if (sample.self_test_passed) self_test_failed_ = !*sample.self_test_passed;
  verdict_ = plausibility_.judge(at.utime, sample.acceleration, sample.angular_rate, sample.fine_steps);
  imu_t message{};
  message.status = status_of(sample);
  const bool clips = (message.status & imu_t::CLIPPING) != 0;
  clips_.add(at.utime, clips);
  if (clips) counters_.add("clipped");
  if (verdict_ != Plausibility::Verdict::kGood) return counters_.add(Plausibility::name(verdict_).counter);

  for (std::size_t i = 0; i < 3; ++i) {
    if (plausibility_.stuck_axes()[i]) counters_.add(kStuckCounters[i]);
  }
  rate_ = sample.angular_rate;
  message.utime = at.utime;
  message.sequence = sequence_;
  std::ranges::copy(sample.acceleration, message.acceleration);
  std::ranges::copy(sample.angular_rate, message.angular_rate);
  message.has_orientation = sample.orientation.has_value();
  if (sample.orientation) std::ranges::copy(*sample.orientation, message.orientation);
  message.temperature = static_cast<float>(sample.temperature.value_or(std::numeric_limits<double>::quiet_NaN()));
  start_.pass(std::move(message), sample.received, [&](imu_t& m) { publish(m, sample.received); });
}

/// An axis that is stuck at the end of its range is not reported as clipping: it is not used in any case.
std::int32_t ImuNode::status_of(const device::ImuSample& sample) const {
  std::int32_t status = self_test_failed_ ? imu_t::SELF_TEST_FAILED : 0;
  if (sample.force_clips) status |= imu_t::CLIPPING;
  for (std::size_t i = 0; i < 3; ++i) {
    if (plausibility_.stuck_axes()[i])
      status |= kStuckBits[i];
    else if (sample.rate_clips[i])
      status |= imu_t::CLIPPING;
  }
  return status;
}

void ImuNode::publish(imu_t& message, std::int64_t now) {
  if (message.utime <= last_utime_) {
    counters_.add("dropped.not_newer");
    return;
  }
  last_utime_ = message.utime;
  bus_.publish("IMU", message);
  counters_.add("samples");
  latency_.add(static_cast<double>(now - message.utime) * 1e-6);
  arrival_.add(message.utime, now);
}

void ImuNode::finish() {
  start_.release([this](imu_t& message) { publish(message, last_sample_); });
}

void ImuNode::restart_clock() {
  counters_.add("clock_restarts");
  clock_ = ClockOffset();
  clock_begun_ = false;
}

/// The host's clock was set: its earlier times are invalid. A step forward looks like a delay, which the clock's window
/// would accept for seconds.
void ImuNode::clock_was_set(std::int64_t by) {
  if (by <= 0) return;  // bytes with earlier times of receipt show it
  counters_.add("clock_jumps");
  clock_ = ClockOffset();
  clock_begun_ = false;
}

void ImuNode::on_clock_set_back(std::int64_t receive_utime) {
  start_.release([&](imu_t& message) { publish(message, receive_utime); });
  counters_.add("clock_jumps");
  clock_ = ClockOffset();
  clock_begun_ = false;
  last_utime_ = 0;
}

ImuNode::HostTime ImuNode::to_host(std::int64_t device_time, std::int64_t receive_utime) {
  const std::int64_t jumps = clock_.jumps(), before = clock_.offset();
  const std::int64_t utime = clock_.to_host(device_time, receive_utime);
  const bool jumped = clock_.jumps() != jumps;
  if (clock_begun_ && !jumped) return {utime, std::max<std::int64_t>(before - clock_.offset(), 0)};
  clock_begun_ = true;
  start_.release([&](imu_t& message) { publish(message, receive_utime); });
  start_.begin(receive_utime);
  if (jumped) {
    counters_.add("clock_jumps");
    if (receive_utime < last_sample_) last_utime_ = 0;  // the host's clock was set back: its earlier times are invalid
  }
  return {utime, 0};
}

void ImuNode::on_link(std::int64_t now, link::LinkState state, const std::string& why) {
  const bool up = state == link::LinkState::kUp;
  if (up || link_fault_.empty()) counters_.add(up ? "link.reopened" : "link.lost");
  link_fault_ = up ? "" : why;
  if (up) {  // another device may have been plugged in, with another clock
    clock_ = ClockOffset();
    clock_begun_ = false;
  }
  device_->on_link(now, state);
}

void ImuNode::tick(std::int64_t now) {
  if (now_ == 0) last_sample_ = now;
  now_ = now;
  if (link_fault_.empty()) device_->tick(now);
  check_garbage(now);
  refusals_.tick(now);
}

/// More garbage than frames within a second is a fault; a single byte now and then is not.
void ImuNode::check_garbage(std::int64_t now) {
  if (std::abs(now - watched_) < kWatchPeriod) return;
  const std::int64_t bytes = counters_["bytes"];
  const std::int64_t garbage = device_->counters()["garbage_bytes"];
  garbled_ = garbage - watched_garbage_ > (bytes - watched_bytes_) / 2;
  watched_ = now;
  watched_bytes_ = bytes;
  watched_garbage_ = garbage;
}

/// Adds faults of the samples.
void ImuNode::report_samples(std::vector<std::string>& faults) const {
  if (verdict_ != Plausibility::Verdict::kGood) faults.emplace_back(Plausibility::name(verdict_).fault);
  for (std::size_t i = 0; i < 3 && verdict_ == Plausibility::Verdict::kGood; ++i) {
    if (!plausibility_.stuck_axes()[i]) continue;
    faults.push_back(
        fmt::format("the IMU's gyro is stuck or at the end of its range about {}, at {:.4f} rad/s: the filter does "
                    "without that axis",
                    "xyz"[i], rate_[i]));
  }
  if (clips_.lasting())
    faults.emplace_back(
        "the IMU clips: it has been at the end of its range for more than 1 s; such samples are not used");
}

NodeReport ImuNode::report() const {
  NodeReport report;
  report.counters = counters_;
  report.counters.add(device_->counters());
  report.latency_p50 = latency_.percentile(0.5);
  report.latency_p99 = latency_.percentile(0.99);

  if (link_report_) link_report_(report);
  if (!link_fault_.empty()) report.faults.push_back(link_fault_);
  const double silent = static_cast<double>(now_ - last_sample_) * 1e-6;
  if (link_fault_.empty() && silent > config_.silence)
    report.faults.push_back(fmt::format("no sample from the IMU for {:.0f} s", silent));
  if (link_fault_.empty() && silent <= config_.silence) report_samples(report.faults);
  if (const auto difference = arrival_.difference()) set_level(report.counters, "clock.difference_us", *difference);
  set_level(report.counters, "clock.drift_ppm", std::llround(clock_.drift().drift() * 1e6));
  if (auto fault = clock_.drift().fault()) report.faults.push_back(std::move(*fault));
  if (auto fault = arrival_.fault()) report.faults.push_back(std::move(*fault));
  if (garbled_) report.faults.emplace_back("garbage from the IMU: wrong baud, or another device");
  if (const auto& fault = refusals_.fault()) report.faults.push_back(*fault);
  if (const std::string fault = device_->fault(); !fault.empty()) report.faults.push_back(fault);
  if (restarts_.often(now_))
    report.faults.push_back(fmt::format("the IMU has restarted {} times within a minute: its supply?", kManyRestarts));
  if (self_test_failed_) report.faults.emplace_back("the IMU's self-test has failed");
  return report;
}

}  // namespace curbstone::imu
