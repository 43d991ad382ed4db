#include "drivers/imu/imu_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include "common/time/microseconds.hpp"

namespace curbstone::imu {

namespace {

constexpr std::int64_t kWatchPeriod = 1'000'000;  // us

MtConfigurator::Settings settings(const ImuConfig& config) {
  return {config.configure, config.rate, config.orientation, microseconds(config.silence)};
}

}  // namespace

ImuNode::ImuNode(const ImuConfig& config, Publisher& bus, Send send)
    : config_(config), bus_(bus), configurator_(settings(config), std::move(send)) {}

void ImuNode::on_bytes(std::int64_t receive_utime, std::span<const std::uint8_t> bytes) {
  counters_.add("bytes", static_cast<std::int64_t>(bytes.size()));
  parser_.parse(receive_utime, bytes, [&](const XbusFrame& frame) {
    note_refusals(receive_utime);
    on_frame(receive_utime, frame);
    if (note_refusals(receive_utime) == 0) refusals_.used(receive_utime);
  });
  note_refusals(receive_utime);
}

/// Returns how many have come since it was called last.
int ImuNode::note_refusals(std::int64_t now) {
  int more = 0;
  for (const Counters* counters : std::initializer_list<const Counters*>{&counters_, &parser_.counters()}) {
    for (const auto& [name, value] : counters->values()) {
      if (!name.starts_with("refused.")) continue;
      for (; noted_[name] < value; ++more) {
        refusals_.refused(now, name);
        noted_.add(name);
      }
    }
  }
  return more;
}

void ImuNode::on_frame(std::int64_t receive_utime, const XbusFrame& frame) {
  configurator_.on_frame(receive_utime, frame);
  if (frame.is(Mid::kWakeUp)) {
    sample_time_ = {};
    restart_clocks();
  }
  if (!frame.is(Mid::kMtData2)) return;
  const std::int64_t under_way =  // 8N1: ten bits a byte
      config_.line == Line::kUart ? static_cast<std::int64_t>(frame.wire_size) * 10'000'000 / config_.baud : 0;
  on_measurement(receive_utime - under_way, decode_mtdata2(frame.data, counters_));
}

void ImuNode::on_measurement(std::int64_t receive_utime, const MtData2& data) {
  if (!data.acceleration || !data.angular_rate) {  // of its GNSS receiver, say, which bear the time of the fix
    counters_.add("skipped.incomplete");
    if (data.packet_counter) packet_counter_.other(*data.packet_counter);
    return;
  }
  const auto [usable, time] = judge(receive_utime, data);
  if (!usable) return;
  if (!time) counters_.add("stamped_on_receipt");
  const HostTime at = time ? to_host(*time, receive_utime) : HostTime{receive_utime, 0};
  ++sequence_;
  configurator_.on_usable_sample(receive_utime);
  last_sample_ = receive_utime;

  imu_t message{};
  message.utime = at.utime;
  message.sequence = sequence_;
  std::copy(data.acceleration->begin(), data.acceleration->end(), message.acceleration);
  std::copy(data.angular_rate->begin(), data.angular_rate->end(), message.angular_rate);
  message.has_orientation = data.orientation.has_value();
  if (data.orientation) std::copy(data.orientation->begin(), data.orientation->end(), message.orientation);
  message.temperature = static_cast<float>(data.temperature.value_or(std::numeric_limits<double>::quiet_NaN()));
  if (data.status) {
    self_test_failed_ = (*data.status & MtData2::kSelfTestPassed) == 0;
    if (self_test_failed_) message.status |= imu_t::SELF_TEST_FAILED;
    if ((*data.status & MtData2::kClipping) != 0) {
      message.status |= imu_t::CLIPPING;
      counters_.add("clipped");
    }
  }
  start_.pass(std::move(message), receive_utime, at.earlier, [&](imu_t& m) { publish(m, receive_utime); });
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
}

void ImuNode::finish() {
  start_.release([this](imu_t& message) { publish(message, last_sample_); });
}

/// Counts losses too, and what is wrong with a sample that is not to be used.
ImuNode::Judged ImuNode::judge(std::int64_t receive_utime, const MtData2& data) {
  const auto& counter = data.packet_counter;
  const auto gap = counter ? packet_counter_.gap(*counter) : std::nullopt;
  const auto ahead = gap ? std::optional(gap->ahead) : std::nullopt;
  int lost = gap ? gap->lost : 0;
  int missing = lost;
  Judged judged;
  if (data.sample_time_fine) {
    using Verdict = SampleTime::Verdict;
    const auto at = sample_time_.next(*data.sample_time_fine, receive_utime, ahead);
    if (at.verdict == Verdict::kRepeated || at.verdict == Verdict::kRefused) {
      counters_.add(at.verdict == Verdict::kRepeated ? "refused.repeated" : "refused.time");
      if (counter) packet_counter_.refused(*counter);
      return {false, {}};
    }
    if (at.verdict == Verdict::kRestarted) restart_clocks();
    judged.time = at.time;
    missing = at.missing;
    if (!ahead || at.verdict == Verdict::kRestarted) lost = missing;
  }
  if (counter) packet_counter_.used(*counter);
  if (lost > 0) counters_.add("lost.packets", lost);
  sequence_ += missing;
  return judged;
}

void ImuNode::restart_clocks() {
  counters_.add("clock_restarts");
  clock_ = ClockOffset();
  clock_begun_ = false;
  packet_counter_.restart();
}

ImuNode::HostTime ImuNode::to_host(std::int64_t device_time, std::int64_t receive_utime) {
  const std::int64_t jumps = clock_.jumps(), before = clock_.offset();
  const std::int64_t utime = clock_.to_host(device_time, receive_utime);
  const bool jumped = clock_.jumps() != jumps;
  if (clock_begun_ && !jumped) return {utime, std::max<std::int64_t>(before - clock_.offset(), 0)};
  clock_begun_ = true;
  start_.release([&](imu_t& message) { publish(message, receive_utime); });
  start_.begin(receive_utime);
  if (jumped) {  // the host's clock was set: its times before mean nothing now
    counters_.add("clock_jumps");
    last_utime_ = 0;
  }
  return {utime, 0};
}

void ImuNode::on_link(std::int64_t now, bool up, const std::string& why) {
  if (up || link_fault_.empty()) counters_.add(up ? "link.reopened" : "link.lost");
  link_fault_ = up ? "" : why;
  parser_.reset();
  if (up) configurator_.start(now);
}

void ImuNode::tick(std::int64_t now) {
  if (now_ == 0) last_sample_ = now;
  now_ = now;
  if (link_fault_.empty()) configurator_.tick(now);
  watch_line(now);
  refusals_.tick(now);
}

/// More garbage than frames within a second is a fault; a byte now and then is not.
void ImuNode::watch_line(std::int64_t now) {
  if (now - watched_ < kWatchPeriod) return;
  const std::int64_t bytes = counters_["bytes"];
  const std::int64_t garbage = parser_.counters()["garbage_bytes"];
  garbled_ = garbage - watched_garbage_ > (bytes - watched_bytes_) / 2;
  watched_ = now;
  watched_bytes_ = bytes;
  watched_garbage_ = garbage;
}

NodeReport ImuNode::report() const {
  NodeReport report;
  report.counters = counters_;
  for (const Counters* more : {&parser_.counters(), &configurator_.counters()}) {
    for (const auto& [name, value] : more->values()) report.counters.add(name, value);
  }
  report.latency_p50 = latency_.percentile(0.5);
  report.latency_p99 = latency_.percentile(0.99);

  if (link_report_) link_report_(report);
  if (!link_fault_.empty()) report.faults.push_back(link_fault_);
  const double silent = static_cast<double>(now_ - last_sample_) * 1e-6;
  if (silent > config_.silence) report.faults.push_back(fmt::format("no sample from the IMU for {:.0f} s", silent));
  if (garbled_) report.faults.push_back("garbage from the IMU: wrong baud, or another device");
  if (const auto& fault = refusals_.fault()) report.faults.push_back(*fault);
  if (const std::string fault = configurator_.fault(); !fault.empty()) report.faults.push_back(fault);
  if (self_test_failed_) report.faults.push_back("the IMU's self-test has failed");
  return report;
}

}  // namespace curbstone::imu
