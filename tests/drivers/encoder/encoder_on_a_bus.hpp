#pragma once

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "tests/drivers/encoder/drive_rig.hpp"

namespace curbstone::encoder {

inline constexpr std::uint32_t kPositions = 0x181;

/// The driver and what it publishes, of wheels that turn at 10 rad/s.
class EncoderOnABus : public ::testing::Test {
 protected:
  explicit EncoderOnABus(const EncoderConfig& config = {}) : rig_(config) {}

  [[nodiscard]] std::vector<std::string> faults() const { return rig_.node.report().faults; }
  [[nodiscard]] std::string counters() const {
    std::string text;
    const NodeReport report = rig_.node.report();
    for (const auto& [name, value] : report.counters.values()) text += name + " " + std::to_string(value) + "\n";
    return text;
  }
  /// Where each message says that the wheels were, they were; it was published once, in order.
  void expect_true_messages(double speed_error = 0.4) {
    const auto& messages = rig_.messages();
    for (std::size_t i = 1; i < messages.size(); ++i) {
      const wheels_t& m = messages[i];
      ASSERT_GT(m.utime, messages[i - 1].utime);
      ASSERT_NEAR(m.angle[0], rig_.angle(m.utime) - rig_.angle(messages[0].utime), 0.012) << i << "\n" << counters();
      ASSERT_NEAR(m.angle[1], m.angle[0], 0.002) << i;
      if (i > 20) {
        ASSERT_NEAR(m.speed[0], 10, speed_error) << i << " at " << seconds_of(m) << " s";
      }
    }
  }
  [[nodiscard]] static double seconds_of(const wheels_t& m) {
    return static_cast<double>(m.utime - test::DriveRig::kStart) * 1e-6;
  }
  /// The drive's position frame of a moment.
  [[nodiscard]] can::CanFrame positions(std::int64_t at) const {
    can::CanFrame frame = can::CanFrame::make(kPositions, {0, 0, 0, 0, 0, 0, 0, 0});
    for (int side = 0; side < 2; ++side) {
      const auto counts = static_cast<std::uint32_t>(rig_.raw(at, side));
      for (int byte = 0; byte < 4; ++byte)
        frame.data[static_cast<std::size_t>(4 * side + byte)] = static_cast<std::uint8_t>(counts >> (8 * byte));
    }
    return frame;
  }

  test::DriveRig rig_;
};

/// A drive that the driver sets up, and that has run for 2 s.
class EncoderOfADrive : public EncoderOnABus {
 protected:
  EncoderOfADrive() {
    rig_.receive(rig_.now, rig_.drive.power_on(rig_.now));
    rig_.drive.set_speeds(955, -955);  // 10 rad/s
    rig_.run_for(2'000'000);
  }
};

/// A drive that somebody else has set up, which sends its positions each `period` us of a time.
class EncoderThatListens : public EncoderOnABus {
 protected:
  EncoderThatListens() : EncoderOnABus(listening()) {}
  void send(double seconds, double period) {
    for (const double end = at_ + seconds * 1e6; at_ < end; at_ += period) {
      const auto now = static_cast<std::int64_t>(at_);
      if (now - ticked_ >= 20'000) rig_.node.tick(ticked_ = now);
      rig_.node.on_frame(now + 150 + static_cast<std::int64_t>(random_() % 200), positions(now));
    }
  }

  std::mt19937 random_{1};
  double at_ = static_cast<double>(test::DriveRig::kStart);
  std::int64_t ticked_ = 0;

 private:
  static EncoderConfig listening() {
    EncoderConfig config;
    config.configure = false;
    return config;
  }
};

}  // namespace curbstone::encoder
