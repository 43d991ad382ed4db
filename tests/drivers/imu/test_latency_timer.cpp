#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "drivers/imu/imu_node.hpp"
#include "drivers/serial/serial_link.hpp"
#include "tests/drivers/driver_on_a_pty.hpp"
#include "tests/drivers/recorder.hpp"
#include "tools/simulate/devices/xsens_emulator.hpp"

// What an FTDI chip's latency timer costs: bytes are held back to the timer's next tick. The smallest delay of five
// seconds (ClockOffset) is taken for none. So the error of the stamps is the smallest delay that occurs: where samples
// and ticks beat, less than the greatest common divisor of their periods.

namespace curbstone::imu {
namespace {

using simulate::devices::XsensEmulator;

struct Error {
  double median = 0, most = 0;  // ms, stamp - truth
};

/// A sample says in its acceleration the how-manieth it is: on a busy machine the first ones may be lost.
constexpr double kPerSample = 1e-4;  // m/s^2

Error error_of(const std::vector<imu_t>& messages, const std::vector<std::int64_t>& truth, std::int64_t from) {
  std::vector<double> errors;
  for (const imu_t& message : messages) {
    const std::int64_t taken = truth.at(static_cast<std::size_t>(std::lround(message.acceleration[0] / kPerSample)));
    if (taken >= from) errors.push_back(static_cast<double>(message.utime - taken) * 1e-3);
  }
  std::ranges::sort(errors, {}, [](double e) { return std::abs(e); });
  return errors.empty() ? Error{1e9, 1e9} : Error{errors[errors.size() / 2], errors.back()};
}

/// 15 seconds of a device whose clock runs fast by 20 ppm, on a line held to ticks with this phase. All times in us.
Error simulate(int rate, std::int64_t timer, std::int64_t phase) {
  test::Recorder<imu_t> recorder("IMU");
  ImuConfig config;
  config.configure = false;
  ImuNode node(config, recorder.bus());
  XsensEmulator device({.configured = true, .rate = rate, .clock_error = 20e-6});
  const std::int64_t start = 1'700'000'000'000'000;
  device.power_on(start);
  std::vector<std::int64_t> truth;
  test::Bytes held;
  std::int64_t tick = start + phase, next = 0;
  for (std::int64_t k = rate; k < 15 * rate; ++k) {
    next = start + k * 1'000'000 / rate;
    for (; timer > 0 && tick < next; tick += timer) {
      if (!held.empty()) node.on_bytes(tick, std::exchange(held, {}));
    }
    const double noise = 1e-3 * static_cast<double>(k % 2);  // no sensor is still
    const double number = kPerSample * static_cast<double>(truth.size());
    test::append(held, device.sample(next, {.acceleration = {number, noise, 9.8 + noise}}));
    truth.push_back(next);
    if (timer == 0) node.on_bytes(next, std::exchange(held, {}));
  }
  return error_of(recorder.messages(), truth, start + 7'000'000);
}

Error worst_phase(int rate, std::int64_t timer) {
  Error worst;
  for (std::int64_t phase = 0; phase < std::max<std::int64_t>(timer, 1); phase += 250) {
    const Error error = simulate(rate, timer, phase);
    if (std::abs(error.most) > std::abs(worst.most)) worst = error;
  }
  fmt::print("{} Hz, timer {} ms: stamps are late by at most {:.2f} ms (the worst phase of the ticks)\n", rate,
             timer / 1000, worst.most);
  return worst;
}

TEST(LatencyTimer, TheErrorOfTheStampsIsTheBeatOfSamplesAndTicks) {
  EXPECT_LE(std::abs(worst_phase(100, 0).most), 0.2);
  EXPECT_LE(std::abs(worst_phase(100, 1000).most), 1.2);
  EXPECT_LE(std::abs(worst_phase(100, 16'000).most), 2.2);
  EXPECT_LE(std::abs(worst_phase(400, 16'000).most), 0.7);
  EXPECT_GT(std::abs(worst_phase(125, 16'000).most), 7) << "8 ms of 16: no beat";
}

/// The same in real time, through a pseudo-terminal and the port's own code.
class LatencyTimerOnAPty : public test::DriverOnAPty<imu_t> {
 protected:
  LatencyTimerOnAPty() : DriverOnAPty("IMU"), node_(config(), recorder_.bus()), link_({pty_.path(), 115200}) {
    link_.attach(loop_, {[this](auto utime, auto bytes) { node_.on_bytes(utime, bytes); },
                         [this](auto now, auto state, const auto& why) { node_.on_link(now, state, why); }});
    loop_.every(std::chrono::milliseconds(10), [this] {
      const std::int64_t now = wall_clock();
      tremor_ = 1e-3 - tremor_;  // no sensor is still
      const double number = kPerSample * static_cast<double>(truth_.size());
      const auto bytes = device_.sample(now, {.acceleration = {number, tremor_, 9.8 + tremor_}});
      if (bytes.empty()) return;
      truth_.push_back(now);
      test::append(held_, bytes);
    });
    loop_.every(std::chrono::milliseconds(16), [this] { pty_.write(std::exchange(held_, {})); });
    device_.power_on(wall_clock());
  }
  static ImuConfig config() {
    ImuConfig config;
    config.configure = false;
    return config;
  }
  [[nodiscard]] NodeReport report() const override { return node_.report(); }

  XsensEmulator device_{{.configured = true}};
  std::vector<std::int64_t> truth_;
  double tremor_ = 0;  // m/s^2
  test::Bytes held_;
  ImuNode node_;
  serial::SerialLink link_;
};

TEST_F(LatencyTimerOnAPty, StampsAreMuchBetterThanTheTimer) {
  ASSERT_TRUE(run_until_more_samples(400));
  const Error error = error_of(recorder_.messages(), truth_, truth_[200]);
  fmt::print("100 Hz, timer 16 ms, on a pty: error of the stamps {:.2f} ms (median), {:.2f} ms (most)\n", error.median,
             error.most);
  EXPECT_LE(std::abs(error.median), 8);
}

}  // namespace
}  // namespace curbstone::imu
