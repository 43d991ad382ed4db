#include "drivers/encoder/modbus_node.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/bus/levels.hpp"
#include "common/time/microseconds.hpp"
#include "drivers/encoder/drive_faults.hpp"

namespace curbstone::encoder {

namespace {
constexpr double kOldStatus = 3;  // readings of the status that failed
}

modbus::ModbusSettings modbus_settings(const EncoderConfig& config) {
  modbus::ModbusSettings settings;
  settings.tcp = config.interface == Interface::kModbusTcp;
  settings.device = config.device;
  settings.baud = config.baud;
  settings.host = config.modbus.host;
  settings.port = config.modbus.port;
  settings.slave = config.modbus.slave;
  settings.timeout = std::int64_t{config.modbus.timeout} * 1000;
  return settings;
}

ModbusNode::ModbusNode(const EncoderConfig& config, Publisher& bus)
    : config_(config),
      odometer_({config.counts_per_revolution, {config.invert_left, config.invert_right}, config.max_speed}),
      stuck_(config.counts_per_revolution),
      output_(bus) {}

void ModbusNode::on_reading(std::int64_t now, const modbus::Reading& reading) {
  link_fault_.clear();
  const std::int64_t elapsed = reading.time - reading_.time;
  const bool first = reading_.time == 0 || elapsed <= 0 || elapsed > microseconds(config_.silence);
  if (first) {
    if (reading_.time != 0) counters_.add("counts_restarted");
    odometer_.restart();
    stuck_.restart();
  }
  output_.restart(reading.utime);
  reading_ = reading;
  last_heard_ = now;
  round_trips_.add(static_cast<double>(reading.round_trip));
  const auto sample = odometer_.update(reading.counts, static_cast<double>(elapsed) * 1e-6);
  if (!sample) return share_.refused(now, odometer_.refusal());
  share_.used(now);
  stuck_.add(reading.time, reading.counts, reading.speeds);
  if (first) return;
  if (stuck_.all_stuck()) return counters_.add("withheld.stuck");
  wheels_t message = WheelsOutput::message(*sample, reading.utime);
  for (std::size_t i = 0; i < 2; ++i)
    message.faults[i] = reading.faults[i] | (stuck_.stuck(i) ? std::int32_t{StuckCounts::kFault} : 0);
  const auto is_of_now = [&](std::int64_t time) { return time != 0 && reading.time - time <= old_status(); };
  message.enabled = !stuck_.stuck(0) && !stuck_.stuck(1) && is_of_now(reading.state_time) && reading.state.enabled &&
                    is_of_now(reading.faults_time) && reading.faults[0] == 0 && reading.faults[1] == 0;
  output_.publish(message, now);
}

void ModbusNode::on_link(link::LinkState state, const std::string& why) {
  const bool up = state == link::LinkState::kUp;
  if (up && was_up_) counters_.add("link.reopened");
  if (!up && was_up_ && link_fault_.empty()) counters_.add("link.lost");
  was_up_ |= up;
  link_fault_ = up ? "" : why;
}

void ModbusNode::clock_was_set(std::int64_t by) {
  began_ += by;
  last_heard_ += by;
}

void ModbusNode::tick(std::int64_t now) {
  if (now_ == 0) began_ = last_heard_ = now;
  now_ = now;
  share_.tick(now);
}

std::int64_t ModbusNode::old_status() const {
  return microseconds(kOldStatus * modbus::DrivePoll::kStatusEvery / config_.modbus.rate) + 1'000'000;
}

void ModbusNode::add_faults_of_drive(NodeReport& report) const {
  if (reading_.time == 0) return;
  const std::int64_t old = old_status();
  // Whether what was read then is of now; otherwise that is the fault.
  const auto is_known = [&](const char* what, std::int64_t time) {
    const std::int64_t age = time != 0 ? now_ - last_heard_ + reading_.time - time : now_ - began_;
    if (age > old)
      report.faults.push_back(
          fmt::format("the drive's {} not known for {:.0f} s", what, static_cast<double>(age) * 1e-6));
    return age <= old;
  };
  if (is_known("faults are", reading_.faults_time)) add_wheel_faults(report, reading_.faults);
  const bool state_is_known = is_known("status is", reading_.state_time);
  if (state_is_known && reading_.state.alarm) report.faults.emplace_back("drive: alarm");
  if (state_is_known && reading_.state.emergency_stop) report.faults.emplace_back("drive: emergency stop");
  add_encoder_lines_fault(report, reading_.encoder_lines, config_);
}

NodeReport ModbusNode::report() const {
  NodeReport report;
  report.counters = counters_;
  report.counters.add(odometer_.counters());
  output_.report(report);
  if (reading_.time != 0) {
    set_level(report.counters, "modbus.round_trip_us", std::llround(round_trips_.percentile(0.5)));
    set_level(report.counters, "stamp.uncertainty_us", std::llround(0.5 * round_trips_.percentile(0.99)));
  }
  if (!link_fault_.empty()) report.faults.push_back(link_fault_);
  const double silent = static_cast<double>(now_ - last_heard_) * 1e-6;
  if (link_fault_.empty() && silent > config_.silence)
    report.faults.push_back(fmt::format("no positions from the drive for {:.0f} s", silent));
  if (silent <= config_.silence) {
    for (std::string& fault : stuck_.faults()) report.faults.push_back(std::move(fault));
  }
  if (share_.fault()) report.faults.push_back(*share_.fault());
  add_faults_of_drive(report);
  if (add_report_) add_report_(report);
  return report;
}

}  // namespace curbstone::encoder
