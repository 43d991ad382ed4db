#include "services/ekf/ekf_node.hpp"

#include <fmt/format.h>

#include <cmath>
#include <variant>

#include "common/bus/levels.hpp"
#include "common/time/has_passed.hpp"
#include "common/time/microseconds.hpp"
#include "services/ekf/ekf_faults.hpp"
#include "services/ekf/ekf_messages.hpp"
#include "services/ekf/state/state_file.hpp"

namespace curbstone::ekf {

namespace {

constexpr std::int64_t kStatePeriod = 100'000;  // us
constexpr std::int64_t kSilence = 1'000'000;    // us without a message that count as a fault
constexpr int kGarbageRun = 20;                 // consecutive refused messages that count as a fault
constexpr std::int32_t kMaxLoss = 100'000;      // a larger step of a sequence is a restart, not a loss

}  // namespace

EkfNode::EkfNode(const base::EkfConfig& config, Publisher& publisher)
    : config_(config),
      publisher_(publisher),
      sent_(publisher, "ODOMETRY"),
      sequencer_(config),
      increments_(config.map),
      accelerometer_(config.vehicle.wheel_radius),
      shaken_imu_(config),
      filter_(config),
      mounting_(config.vehicle) {
  if (config_.state_file.empty()) return;
  if (const auto belief = state::load_state(config_.state_file)) {
    filter_.inherit(*belief);
    mounting_.begin_with(belief->imu_turn);
  }
  state_keeper_.emplace(config_.state_file);
}

void EkfNode::tick(std::int64_t now) {
  if (is_over_) return;
  imu_.silence.tick(now);
  wheels_.silence.tick(now);
  start_.tick(now);
  sent_.tick();
  if (!state_keeper_ || !filter_.filter().started()) return;
  if (!has_passed(kStatePeriod, state_kept_, now)) return;
  state_kept_ = now;
  model::Belief belief = filter_.filter().axes().with_restored_biases(filter_.filter().belief());
  belief.utime += clock_.offset();
  state_keeper_->keep(belief);
}

void EkfNode::connect(Subscriber& bus) {
  bus.subscribe<imu_t>("IMU", [this](const imu_t& message) { on(message); });
  bus.subscribe<wheels_t>("WHEELS", [this](const wheels_t& message) { on(message); });
  bus.subscribe<resend_request_t>(kResendRequests, [this](const resend_request_t& m) { sent_.request(m); }, {100});
  if (config_.fuse_map) bus.subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& message) { on(message); });
}

/// Whether the message may be used. Counts it, and those that were lost before it.
template <class Message>
bool EkfNode::accept(Input& input, const Message& message) {
  counters_.add(std::string("messages.") + input.counter);
  const char* cause = why_refused(message);
  if (cause == nullptr && !input.sender.accept(message.utime, message.sequence)) {
    counters_.add(std::string("refused.second_sender.") + input.counter);
    return false;
  }
  count_lost_messages(input, message.sequence);
  if (cause != nullptr) {
    refuse(input, cause);
    return false;
  }
  input.refused_in_a_row = 0;
  input.heard = message.utime;
  input.silence.heard();
  return true;
}

void EkfNode::on(const imu_t& message) {
  if (!accept(imu_, message)) return;
  imu_status_ = message.status;
  const std::int64_t offset_before = clock_.offset();
  const std::optional<std::int64_t> utime =
      clock_.add(inputs::RunningClock::Sensor::kImu, message.utime, message.sequence);
  if (clock_.offset() != offset_before) increments_.interrupt();
  if (!utime) return;
  if (clock_.offset() > offset_before) sequencer_.drop_wheels_after(*utime + inputs::RunningClock::kMinLeap);
  base::ImuSample sample = sample_of(message);
  sample.utime = imu_stamps_.add(*utime, message.sequence);
  if (sample.utime != *utime) counters_.add("straightened.imu");
  // The true value of an axis at the end of its range is unknown: the sample counts as lost, and the wheels bridge it.
  if (message.status & imu_t::CLIPPING) return counters_.add("refused.clipping.imu");
  const std::int64_t lone_before = imu_outliers_.refused();
  for (const base::ImuSample& usable : imu_outliers_.add(sample)) sequencer_.push(usable);
  if (imu_outliers_.refused() > lone_before) counters_.add("refused.lone.imu", imu_outliers_.refused() - lone_before);
  process_due();
}

void EkfNode::on(const wheels_t& message) {
  if (!accept(wheels_, message)) return;
  last_wheels_ = message;
  base::WheelSample sample = sample_of(message);
  const std::int64_t offset_before = clock_.offset();
  const std::optional<std::int64_t> utime =
      clock_.add(inputs::RunningClock::Sensor::kWheels, message.utime, message.sequence, sample.angle);
  if (clock_.offset() != offset_before) increments_.interrupt();
  if (!utime) return;
  sample.utime = *utime;
  sequencer_.push(sample);
  process_due();
}

void EkfNode::on(const map_pose_t& message) {
  counters_.add("messages.map");
  map_pose_t pose = message;
  pose.utime -= clock_.offset();
  if (const std::optional<inputs::MapIncrement> increment = increments_.add(pose)) sequencer_.push(*increment);
}

void EkfNode::process_due() {
  while (const auto sample = sequencer_.pop()) process(*sample);
}

void EkfNode::end_drive() {
  is_over_ = true;
  while (const auto sample = sequencer_.pop_rest()) process(*sample);
}

void EkfNode::process(const inputs::Sequencer::Sample& sample) {
  const auto* wheels = std::get_if<base::WheelSample>(&sample);
  if (wheels != nullptr && stale_counts_.is_stale(*wheels)) return counters_.add("refused.old_counts");
  if (wheels != nullptr) accelerometer_.add(*wheels);
  const auto* imu = std::get_if<base::ImuSample>(&sample);
  if (imu != nullptr && accelerometer_.add(*imu)) return counters_.add("refused.stuck.imu");
  check_mounting(sample);
  estimates_.clear();
  if (const auto usable = usable_of(sample)) filter_.add(*usable, estimates_);
  for (const model::Estimate& estimate : estimates_) publish(estimate);
}

/// Drops samples of an IMU whose accelerometer does not measure gravity, that has another axis up, or that is shaken
/// too hard once the filter has started; marks a gyro that does not measure turns; turns an IMU of another yaw.
std::optional<inputs::Sequencer::Sample> EkfNode::usable_of(const inputs::Sequencer::Sample& sample) {
  const auto* measured = std::get_if<base::ImuSample>(&sample);
  if (measured == nullptr) return sample;
  if (mounting_.wrong_gravity()) {
    counters_.add("refused.gravity.imu");
    return {};
  }
  if (mounting_.imu_is_misplaced() || (!filter_.filter().started() && mounting_.may_have_wrong_up())) {
    counters_.add("refused.misplaced.imu");
    return {};
  }
  if (shaken_imu_.add(*measured) && filter_.filter().started()) {
    counters_.add("refused.shaken.imu");
    return {};
  }
  base::ImuSample imu = *measured;
  if (mounting_.gyro_is_wrong()) imu.stuck.fill(true);
  return mounting_.turned(imu);
}

void EkfNode::check_mounting(const inputs::Sequencer::Sample& sample) {
  const auto wrong = [this] {
    return std::array{mounting_.wrong_up().has_value(), mounting_.turns_opposite(), mounting_.missing_yaw().has_value(),
                      mounting_.wrong_turn_scale().has_value(), mounting_.mirrored().has_value()};
  };
  const auto before = wrong();
  const auto& watch = filter_.filter().wheel_watch();
  const bool one_wheel_is_wrong = watch.faulty(0) != watch.faulty(1);  // both turn as no vehicle does, then
  const auto* wheels = std::get_if<base::WheelSample>(&sample);
  if (wheels != nullptr && !one_wheel_is_wrong) mounting_.add(*wheels);
  const auto* imu = std::get_if<base::ImuSample>(&sample);
  const bool whole = !filter_.filter().axes().any() && !filter_.filter().vertical_force().replaced();
  if (imu != nullptr && whole) mounting_.add(*imu);
  const auto now = wrong();
  constexpr std::array kNames = {"faults.mounting.up", "faults.mounting.turn", "faults.mounting.forward",
                                 "faults.mounting.turn_scale", "faults.mounting.hand"};
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (now[i] && !before[i]) counters_.add(kNames[i]);
  }
}

void EkfNode::publish(const model::Estimate& estimate) {
  latency_.add(base::seconds_between(estimate.utime, sequencer_.newest()));
  last_ = estimate;
  odometry_t odometry = odometry_message(estimate);
  odometry.utime += clock_.offset();
  publisher_.publish("ODOMETRY", odometry);
  sent_.keep(odometry);
  pose_t pose = pose_message(estimate);
  pose.utime = odometry.utime;
  publisher_.publish("POSE", pose);
  counters_.add("published.odometry");
}

void EkfNode::count_lost_messages(Input& input, std::int32_t sequence) {
  if (input.sequence) {
    const std::int64_t step = std::int64_t{sequence} - *input.sequence;
    if (step > 1 && step < kMaxLoss) counters_.add(std::string("lost.") + input.counter, step - 1);
  }
  input.sequence = sequence;
}

void EkfNode::refuse(Input& input, const char* cause) {
  ++input.refused_in_a_row;
  counters_.add(fmt::format("refused.{}.{}", cause, input.counter));
}

void EkfNode::describe_input(const Input& input, std::vector<std::string>& faults) const {
  if (input.refused_in_a_row >= kGarbageRun)
    faults.push_back(fmt::format("{}: garbage, the last {} messages were refused", input.name, input.refused_in_a_row));
  else if (input.silence.never_came())
    faults.push_back(fmt::format("{}: nothing heard yet", input.name));
  else if (input.silence.was_heard() && input.silence.silent() > kSilence)
    faults.push_back(
        fmt::format("{}: silent for {:.1f} s", input.name, static_cast<double>(input.silence.silent()) * 1e-6));
  if (input.sender.two_send())
    faults.push_back(
        fmt::format("{0}: two programs send it, and the one heard first is used: end the other (a second "
                    "driver, or a log that is played into the bus)",
                    input.name));
}

NodeReport EkfNode::report() const {
  NodeReport report;
  add_counters(report.counters);
  report.latency_p50 = latency_.percentile(0.5);
  report.latency_p99 = latency_.percentile(0.99);
  describe_input(imu_, report.faults);
  describe_input(wheels_, report.faults);
  describe_devices(report.faults);
  describe_mounting(mounting_, config_.vehicle, report.faults);
  describe_imu_outliers(imu_outliers_, report.faults);
  describe_accelerometer(accelerometer_, report.faults);
  if (!filter_.filter().started()) {
    if (start_.never_came())
      report.faults.emplace_back("no odometry yet: waiting to stand still or to see the wheels turn");
  } else if (last_) {
    describe_odometry(*last_, report.faults);
  }
  return report;
}

void EkfNode::add_counters(Counters& counters) const {
  counters.add(counters_);
  const Counters filtering = filter_.counters();
  for (const Counters* part : {&clock_.counters(), &increments_.counters(), &sequencer_.counters(), &filtering})
    counters.add(*part);
  const inputs::ImuNoise& noise = shaken_imu_.noise();
  set_level(counters, "imu.gyro_noise_percent", std::lround(100.0 * noise.gyro() / config_.noise.gyro));
  set_level(counters, "imu.accelerometer_noise_percent",
            std::lround(100.0 * noise.accelerometer() / config_.noise.accelerometer));
  if (sent_.resent() > 0) counters.add("resent.odometry", sent_.resent());
  if (state_keeper_) counters.add("faults.state_file", state_keeper_->failures());
}

/// Faults that the devices report, and those of the state file.
void EkfNode::describe_devices(std::vector<std::string>& faults) const {
  if (imu_status_ & imu_t::SELF_TEST_FAILED) faults.emplace_back("IMU: its self test failed");
  for (int i = 0; i < 2; ++i) {
    if (last_wheels_.faults[i] == 0) continue;
    faults.push_back(fmt::format("WHEELS: {} drive reports fault {:#x}", i == 0 ? "left" : "right",
                                 static_cast<std::uint32_t>(last_wheels_.faults[i])));
  }
  if (state_keeper_ && state_keeper_->failing())
    faults.push_back(fmt::format("{} cannot be written: if this process dies, the next one starts on the move (mkdir?)",
                                 state_keeper_->path()));
}

/// Faults of the odometry that is published, once the filter has started.
void EkfNode::describe_odometry(const model::Estimate& last, std::vector<std::string>& faults) const {
  if (!last.level) faults.emplace_back("not level yet after a start on the move: the mapper goes by LiDAR alone");
  const bool clips = (imu_status_ & imu_t::CLIPPING) && last.utime + clock_.offset() - imu_.heard <= kSilence;
  if (last.no_imu)
    faults.emplace_back(clips ? "IMU: it clips, odometry coasts on the wheels"
                              : "no IMU: odometry coasts on the wheels");
  const filter::Filter& filter = filter_.filter();
  if (!mounting_.gyro_is_wrong()) describe_axes(filter.axes(), faults);
  describe_leap(filter, faults);
  describe_vertical_force(filter.vertical_force(), faults);
  describe_noise(shaken_imu_, config_.noise, faults);
  describe_wheels(filter.wheel_watch(), faults);
  if (last.no_wheels) faults.emplace_back("no wheels: odometry coasts on the IMU, and drifts");
}

}  // namespace curbstone::ekf
