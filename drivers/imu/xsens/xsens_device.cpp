#include "drivers/imu/xsens/xsens_device.hpp"

#include <cmath>
#include <utility>

namespace curbstone::imu::xsens {

namespace {

/// Rotation vector of a unit quaternion, rad.
std::array<double, 3> rotation_vector(const std::array<double, 4>& q) {
  const double sine = std::hypot(q[1], q[2], q[3]);
  const double angle = 2 * std::atan2(std::copysign(sine, q[0]), std::abs(q[0]));  // q and -q are the same rotation
  const double scale = sine > 0 ? angle / sine : 0;
  return {scale * q[1], scale * q[2], scale * q[3]};
}

}  // namespace

XsensDevice::XsensDevice(const device::DeviceSettings& settings, Send send)
    : settings_(settings),
      configurator_({settings.configure, settings.rate, settings.orientation, settings.patience}, std::move(send)) {}

void XsensDevice::on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes, const Handler& handler) {
  parser_.parse(now, bytes, [&](const XbusFrame& frame) { on_frame(now, frame, handler); });
}

void XsensDevice::on_frame(std::int64_t now, const XbusFrame& frame, const Handler& handler) {
  configurator_.on_frame(now, frame);
  if (frame.is(Mid::kWakeUp)) {
    sample_time_ = {};
    restart_clock();
  }
  if (!frame.is(Mid::kMtData2)) return;
  const MtData2 data = decode_mtdata2(frame.data, counters_);
  if (data.truncated) return;
  if (data.sample_time_fine && data.delta_velocity) velocity_interval_.seen(*data.sample_time_fine);
  if (data.sample_time_fine && data.delta_rotation) rotation_interval_.seen(*data.sample_time_fine);
  if (!(data.acceleration && data.angular_rate) && !(data.delta_velocity && data.delta_rotation)) {
    counters_.add("skipped.incomplete");
    if (data.packet_counter) packet_counter_.other(*data.packet_counter);
    return;
  }
  device::ImuSample sample;
  sample.fine_steps = true;
  const auto bits = static_cast<std::int64_t>(frame.wire_size) * 10;  // 8N1: ten bits per byte
  sample.received = now - (settings_.uart ? bits * 1'000'000 / settings_.baud : 0);
  if (!judge(data, sample)) return;
  if (!measure(data, sample)) return counters_.add("skipped.no_interval");
  configurator_.on_usable_sample();
  sample.orientation = data.orientation;
  sample.temperature = data.temperature;
  if (data.status) {
    sample.self_test_passed = (*data.status & MtData2::kSelfTestPassed) != 0;
    sample.force_clips = (*data.status & MtData2::kForceClips) != 0;
    for (std::size_t i = 0; i < 3; ++i) sample.rate_clips[i] = (*data.status & MtData2::kRateClips << i) != 0;
  }
  sample.restarted = std::exchange(restarted_, false);
  handler(sample);
}

/// Increments are integrals of the device's fast inner samples, with coning and sculling compensated. Divided by the
/// own interval they are the means that an integration needs; nothing is lost to the device's output filter. If only
/// some samples have them, the others would overlap with them: acceleration and rate of turn are used then, if present.
bool XsensDevice::measure(const MtData2& data, device::ImuSample& sample) const {
  const double interval = sample_time_.interval();  // us
  const auto velocity = velocity_interval_.samples(interval), rotation = rotation_interval_.samples(interval);
  const bool known = data.delta_velocity && data.delta_rotation && velocity && rotation;
  const bool complete = data.acceleration && data.angular_rate;
  if (known && (!complete || (*velocity == 1 && *rotation == 1))) {
    sample.acceleration = *data.delta_velocity;
    sample.angular_rate = rotation_vector(*data.delta_rotation);
    for (double& a : sample.acceleration) a /= *velocity * interval * 1e-6;
    for (double& w : sample.angular_rate) w /= *rotation * interval * 1e-6;
    return true;
  }
  if (!complete) return false;
  sample.acceleration = *data.acceleration;
  sample.angular_rate = *data.angular_rate;
  return true;
}

/// Sets time and losses. Returns false if the sample is wrong; counts the cause.
bool XsensDevice::judge(const MtData2& data, device::ImuSample& sample) {
  const auto& counter = data.packet_counter;
  const auto gap = counter ? packet_counter_.gap(*counter) : std::nullopt;
  int lost = gap ? gap->lost : 0;
  sample.missing = lost;
  if (data.sample_time_fine) {
    using Verdict = device::SampleTime::Verdict;
    const auto ahead = gap ? std::optional(gap->ahead) : std::nullopt;
    const auto at = sample_time_.next(*data.sample_time_fine, sample.received, ahead, gap ? gap->others : 0);
    if (at.verdict == Verdict::kLate) return judge_counter(*counter, *gap);
    if (at.verdict == Verdict::kRepeated || at.verdict == Verdict::kRefused) {
      counters_.add(at.verdict == Verdict::kRepeated ? "refused.repeated" : "refused.time");
      if (counter) packet_counter_.refused(*counter);
      return false;
    }
    if (at.verdict == Verdict::kRestarted) restart_clock();
    sample.time = at.time;
    sample.missing = at.missing;
    if (!gap || at.verdict == Verdict::kRestarted) lost = at.missing;
  } else if (gap && gap->ahead <= 0) {
    return judge_counter(*counter, *gap);
  }
  if (counter) packet_counter_.used(*counter);
  if (lost > 0) counters_.add("lost.packets", lost);
  return true;
}

/// A message whose counter is not after that of the latest sample.
bool XsensDevice::judge_counter(std::uint16_t counter, const PacketCounter::Gap& gap) {
  const bool was_lost = gap.ahead < 0 && packet_counter_.found(counter);
  counters_.add(was_lost ? "refused.late" : "refused.repeated");
  if (was_lost) counters_.add("lost.packets", -1);  // it was not lost after all
  return false;
}

void XsensDevice::restart_clock() {
  restarted_ = true;
  packet_counter_.restart();
}

void XsensDevice::on_link(std::int64_t now, link::LinkState state) {
  parser_.reset();
  if (state == link::LinkState::kDown) return;
  sample_time_ = {};  // another device may have been plugged in
  packet_counter_.restart();
  velocity_interval_.restart();
  rotation_interval_.restart();
  configurator_.start(now);
}

Counters XsensDevice::counters() const {
  Counters all = counters_;
  for (const Counters* more : {&parser_.counters(), &configurator_.counters()}) all.add(*more);
  return all;
}

}  // namespace curbstone::imu::xsens
