#pragma once

#include <gmock/gmock.h>

#include <cmath>
#include <curbstone/wheels_t.hpp>
#include <deque>
#include <functional>
#include <memory>

#include "drivers/encoder/encoder_node.hpp"
#include "tests/drivers/recorder.hpp"
#include "tools/simulate/devices/can_drive_emulator.hpp"

namespace curbstone::test {

/// The driver and an emulated drive on a bus with delays, on a clock that the test turns.
class DriveRig {
 public:
  static constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us
  static constexpr double kCounts = 4096;

  explicit DriveRig(const encoder::EncoderConfig& config = {},
                    const simulate::devices::CanDriveEmulator::Settings& device = {})
      : drive(device), node(config, recorder_.bus(), [this](const encoder::can::CanFrame& frame) {
          if (connected) on_bus_.push_back(frame);
        }) {}

  /// Runs both ends for `us`, in steps of 1 ms; samples are taken when the drive's timers say so.
  void run_for(std::int64_t us) {
    for (const std::int64_t end = now + us; now < end; now += 1000) {
      const bool awake = now >= asleep_until_;
      if (awake && (now - kStart) % 20'000 == 0) {
        if (notified_ != host_set_by) node.clock_was_set(host_set_by - notified_);
        notified_ = host_set_by;
        node.tick(now + host_set_by);
      }
      while (!on_bus_.empty()) {
        const encoder::can::CanFrame frame = on_bus_.front();
        on_bus_.pop_front();
        drive.set_counts(raw(now, 0), raw(now, 1));  // a start sends at once
        receive(now, drive.on_frame(now, frame));
      }
      for (auto due = drive.next_due(); due && *due < now + 1000; due = drive.next_due()) {
        drive.set_counts(raw(*due, 0), raw(*due, 1));
        receive(*due, drive.tick(*due));
      }
      if (awake) deliver(now + 1000);
    }
  }
  /// From now on the host does nothing for `us`; what comes waits for it.
  void sleep_for(std::int64_t us) { asleep_until_ = now + us; }
  void receive(std::int64_t at, const simulate::devices::CanDriveEmulator::Frames& frames) {
    for (encoder::can::CanFrame frame : frames) {
      if (!connected || lost(frame)) continue;
      corrupt(frame);
      late_.insert(late_.end(), static_cast<std::size_t>(copies(frame)), {at + delay(frame), frame});
    }
  }
  /// Raw counts: left forward, right mirrored.
  [[nodiscard]] std::int32_t raw(std::int64_t at, int side) const {
    const double counts = std::floor(angle(at) * kCounts / (2 * M_PI));
    const std::int64_t forward = static_cast<std::int64_t>(counts) + first_count;
    const std::int64_t whole = side == 0 ? forward : -forward;
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(whole));
  }
  [[nodiscard]] double angle(std::int64_t at) const { return speed * static_cast<double>(at - kStart) * 1e-6; }
  const std::vector<wheels_t>& messages() { return recorder_.messages(); }
  [[nodiscard]] std::int64_t count(std::string_view name) const { return node.report().counters[name]; }

  std::int64_t now = kStart;
  std::int64_t host_set_by = 0;  // us: its clock against this
  double speed = 10;             // rad/s
  std::int64_t first_count = 0;
  bool connected = true;
  std::function<std::int64_t(const encoder::can::CanFrame&)> delay = [](const encoder::can::CanFrame&) {
    return std::int64_t{200};
  };
  std::function<bool(const encoder::can::CanFrame&)> lost = [](const encoder::can::CanFrame&) { return false; };
  std::function<void(encoder::can::CanFrame&)> corrupt = [](encoder::can::CanFrame&) {};
  std::function<int(const encoder::can::CanFrame&)> copies = [](const encoder::can::CanFrame&) { return 1; };
  simulate::devices::CanDriveEmulator drive;

 private:
  struct Late {
    std::int64_t at;
    encoder::can::CanFrame frame;
  };
  void deliver(std::int64_t until) {  // in order: a bus is a queue
    while (!late_.empty() && late_.front().at < until) {
      const Late late = late_.front();
      late_.pop_front();
      arrived_ = std::max({arrived_, late.at, asleep_until_});
      node.on_frame(arrived_ + host_set_by, late.frame);
    }
  }
  Recorder<wheels_t> recorder_{"WHEELS"};
  std::deque<encoder::can::CanFrame> on_bus_;
  std::deque<Late> late_;
  std::int64_t arrived_ = 0;
  std::int64_t asleep_until_ = 0;
  std::int64_t notified_ = 0;

 public:
  encoder::EncoderNode node;
};

}  // namespace curbstone::test
