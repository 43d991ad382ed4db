#include "drivers/serial/serial_link.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "common/bus/levels.hpp"
#include "common/time/clock.hpp"

namespace curbstone::serial {

namespace {
constexpr double kBaudError = 0.02;  // a byte of ten bits is misread from 5 % on, both ends together
constexpr int kMaxReads = 16;  // at a time: a device that sends without a pause must not starve the rest of the process
}  // namespace

SerialLink::SerialLink(SerialSettings settings) : settings_(std::move(settings)) {
  try {
    open();
  } catch (const NotASerialPort&) {
    throw;
  } catch (const std::runtime_error& error) {
    why_ = error.what();
    retry_.failed(steady_clock());
  }
}

void SerialLink::open() {
  port_.emplace(settings_);
  why_.clear();
  set_level(counters_, "serial.baud", port_->baud());
  if (!settings_.low_latency) return;
  const LowLatency& granted = port_->low_latency();
  set_level(counters_, "serial.low_latency", granted.granted ? 1 : 0);
  if (!granted.granted) counters_.add("serial.low_latency_refused");
  if (granted.timer_ms) set_level(counters_, "serial.latency_timer_ms", *granted.timer_ms);
}

void SerialLink::attach(EventLoop& loop, Handlers handlers) {
  loop_ = &loop;
  handlers_ = std::move(handlers);
  if (port_) {
    watch();
  } else {
    handlers_.on_link(wall_clock(), link::LinkState::kDown, why_);
  }
  loop.every(std::chrono::milliseconds(100), [this] { try_to_open(); });
}

void SerialLink::watch() {
  loop_->watch(port_->fd(), [this] { on_readable(); });
  if (!queue_.empty()) loop_->watch_writable(port_->fd(), [this] { on_writable(); });
}

void SerialLink::on_readable() {
  for (int i = 0; i < kMaxReads && port_; ++i) {
    const SerialPort::Read read = port_->read(buffer_);
    if (read.status == SerialPort::Status::kNothing) return;
    if (read.status == SerialPort::Status::kGone) return lose();
    // Stamped after the read: a busy host may suspend this process before it for any time, and bytes that arrive
    // meanwhile would seem to have arrived before they were sent. One such sample falsifies a device's clock for
    // seconds (ClockOffset).
    handlers_.on_bytes(wall_clock(), std::span(buffer_).first(read.size));
  }
}

void SerialLink::lose() {
  loop_->unwatch(port_->fd());
  port_.reset();
  queue_.clear();
  retry_.lost(steady_clock());
  handlers_.on_link(wall_clock(), link::LinkState::kDown,
                    fmt::format("serial port {} has vanished; waiting for it to come back", settings_.device));
}

void SerialLink::try_to_open() {
  if (port_ || !retry_.due(steady_clock())) return;
  try {
    open();
  } catch (const std::runtime_error& error) {
    retry_.failed(steady_clock());
    handlers_.on_link(wall_clock(), link::LinkState::kDown, error.what());
    return;
  }
  watch();
  handlers_.on_link(wall_clock(), link::LinkState::kUp, "");
}

void SerialLink::send(std::span<const std::uint8_t> bytes) {
  if (!port_) return counters_.add("dropped.serial_away");
  if (!queue_.has_room(bytes.size())) return counters_.add("dropped.serial_full");
  const bool waiting = !queue_.empty();
  if (!waiting) bytes = bytes.subspan(port_->write(bytes));
  if (bytes.empty()) return;
  queue_.push(bytes);
  if (!waiting && loop_ != nullptr) loop_->watch_writable(port_->fd(), [this] { on_writable(); });
}

void SerialLink::on_writable() {
  if (port_) queue_.pop(port_->write(queue_.front()));
  if (port_ && queue_.empty()) loop_->unwatch_writable(port_->fd());
}

void SerialLink::report(NodeReport& report) const {
  report.counters.add(counters_);
  if (!port_ || port_->baud() == 0) return;
  if (std::abs(port_->baud() - settings_.baud) > kBaudError * settings_.baud) {
    report.faults.push_back(fmt::format("serial port {} runs at {} baud: its driver cannot do {}", settings_.device,
                                        port_->baud(), settings_.baud));
  }
}

}  // namespace curbstone::serial
