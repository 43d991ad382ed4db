#include "drivers/serial/serial_link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "common/time/clock.hpp"

namespace curbstone::serial {

namespace {
constexpr std::int64_t kFirstRetry = 100'000;  // us
constexpr std::int64_t kLastRetry = 2'000'000;
constexpr int kMaxReads = 16;  // at a time: a device that never pauses must not starve the rest of the process
}  // namespace

void SerialLink::attach(EventLoop& loop, Handlers handlers) {
  loop_ = &loop;
  handlers_ = std::move(handlers);
  watch();
  loop.every(std::chrono::milliseconds(100), [this] { try_to_open(); });
}

void SerialLink::watch() {
  loop_->watch(port_->fd(), [this] { on_readable(); });
}

void SerialLink::on_readable() {
  for (int i = 0; i < kMaxReads && port_; ++i) {
    const SerialPort::Read read = port_->read(buffer_);
    if (read.status == SerialPort::Status::kNothing) return;
    if (read.status == SerialPort::Status::kGone) return lose();
    // After the read: a busy host may stop us before it for as long as it likes, and bytes that come meanwhile would
    // seem to have come before they were sent. One such sample puts a device's clock wrong for seconds (ClockOffset).
    handlers_.on_bytes(wall_clock(), std::span(buffer_).first(read.size));
  }
}

void SerialLink::lose() {
  loop_->unwatch(port_->fd());
  port_.reset();
  retry_after_ = kFirstRetry;
  retry_at_ = steady_clock() + retry_after_;
  handlers_.on_link(wall_clock(), false,
                    fmt::format("serial port {} has vanished; waiting for it to come back", settings_.device));
}

void SerialLink::try_to_open() {
  if (port_ || steady_clock() < retry_at_) return;
  try {
    port_.emplace(settings_);
  } catch (const std::runtime_error& error) {
    retry_after_ = std::min(2 * retry_after_, kLastRetry);
    retry_at_ = steady_clock() + retry_after_;
    handlers_.on_link(wall_clock(), false, error.what());
    return;
  }
  watch();
  handlers_.on_link(wall_clock(), true, "");
}

void SerialLink::send(std::span<const std::uint8_t> bytes) {
  if (port_) port_->write(bytes);
}

}  // namespace curbstone::serial
