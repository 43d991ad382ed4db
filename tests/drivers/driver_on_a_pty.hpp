#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <string>

#include "common/bus/node.hpp"
#include "common/shell/event_loop.hpp"
#include "common/time/clock.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/pty.hpp"
#include "tests/drivers/recorder.hpp"

namespace curbstone::test {

/// A driver as its program runs it, which publishes Message, and an emulated device, at the two ends of a
/// pseudo-terminal, in real time. The fixture that derives from it owns both.
template <class Message>
class DriverOnAPty : public ::testing::Test {
 protected:
  explicit DriverOnAPty(const std::string& channel) : recorder_(channel) {
    loop_.every(std::chrono::milliseconds(10), [this] {
      if (done_) done_();
    });
  }
  [[nodiscard]] virtual NodeReport report() const = 0;

  /// Runs until `done`, and says whether it came to that within a minute, which an idle machine does not need.
  bool run_until(const std::function<bool()>& done) {
    const std::int64_t deadline = steady_clock() + 60'000'000;
    bool reached = false;
    done_ = [&] {
      reached = done();
      if (reached || steady_clock() > deadline) loop_.stop();
    };
    loop_.run();
    done_ = nullptr;
    return reached;
  }
  bool run_until_more_samples(std::size_t more) {
    const std::size_t before = recorder_.messages().size();
    return run_until([&] { return recorder_.messages().size() >= before + more; });
  }
  bool run_until_fault(const std::string& text) {
    return run_until([&] {
      for (const std::string& fault : report().faults) {
        if (fault.find(text) != std::string::npos) return true;
      }
      return false;
    });
  }
  bool run_until_healthy() {
    return run_until([&] { return report().faults.empty(); });
  }
  void make_noise(std::size_t bytes) {
    if (noise_) pty_.write(random_bytes(random_, bytes));
  }

  EventLoop loop_;
  Pty pty_;
  Recorder<Message> recorder_;
  bool mute_ = false;   ///< the device says nothing
  bool noise_ = false;  ///< there are other bytes between the device's

 private:
  std::function<void()> done_;
  std::mt19937 random_{1};
};

}  // namespace curbstone::test
