#include "drivers/serial/low_latency.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/drivers/pty.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::serial {
namespace {

/// A pseudo-terminal that has the latency timer of an FTDI chip in a sysfs of its own.
class LowLatencyTest : public ::testing::Test {
 protected:
  LowLatencyTest() {
    const auto port = std::filesystem::canonical(pty_.path()).filename();
    timer_ = sys_.path() / "bus/usb-serial/devices" / port / "latency_timer";
    std::filesystem::create_directories(timer_.parent_path());
  }
  void set_timer(int ms) { std::ofstream(timer_) << ms << "\n"; }
  LowLatency request() { return request_low_latency(pty_.fd(), pty_.path(), sys_.path()); }

  test::Pty pty_;
  test::TemporaryFolder sys_;
  std::filesystem::path timer_;
};

TEST_F(LowLatencyTest, TheTimerOfAnFtdiChipIsSetToAMillisecondBehindTheNameOfTheDevice) {
  set_timer(16);
  EXPECT_EQ(request(), (LowLatency{false, 1}));
}

TEST_F(LowLatencyTest, AShortTimerIsLeftAsItIs) {
  set_timer(1);
  std::filesystem::permissions(timer_, std::filesystem::perms::owner_read);
  EXPECT_EQ(request(), (LowLatency{false, 1}));
}

TEST_F(LowLatencyTest, APortWithoutSuchAChipHasNoTimer) {
  EXPECT_EQ(request(), LowLatency{});
}

TEST_F(LowLatencyTest, ATimerThatTellsNoNumberIsNone) {
  std::ofstream(timer_) << "soon\n";
  EXPECT_EQ(request(), LowLatency{});
}

}  // namespace
}  // namespace curbstone::serial
