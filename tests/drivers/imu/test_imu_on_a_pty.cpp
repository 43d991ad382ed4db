#include <gmock/gmock.h>
#include <sys/wait.h>

#include <curbstone/imu_t.hpp>

#include "common/time/clock.hpp"
#include "drivers/imu/imu_node.hpp"
#include "drivers/serial/serial_link.hpp"
#include "tests/drivers/driver_on_a_pty.hpp"
#include "tests/drivers/stopped_after.hpp"
#include "tests/paths.hpp"
#include "tools/simulate/devices/xsens_emulator.hpp"

namespace curbstone::imu {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The driver as the program runs it, and an emulated device, at the two ends of a pseudo-terminal, in real time.
class ImuOnAPty : public test::DriverOnAPty<imu_t> {
 protected:
  ImuOnAPty()
      : DriverOnAPty("IMU"),
        node_(ImuConfig{}, recorder_.bus(), [this](auto bytes) { link_.send(bytes); }),
        link_({pty_.path(), 115200}) {
    link_.attach(loop_, {[this](auto utime, auto bytes) { node_.on_bytes(utime, bytes); },
                         [this](auto now, auto state, const auto& why) { node_.on_link(now, state, why); }});
    loop_.every(20ms, [this] { node_.tick(wall_clock()); });
    loop_.every(10ms, [this] { turn_device(); });
    pty_.write(device_.power_on(steady_clock()));
  }

  void turn_device() {
    const std::int64_t now = steady_clock();
    pty_.write(device_.on_bytes(now, pty_.read()));
    tremor_ = 1e-3 - tremor_;  // no sensor is still
    const auto bytes = device_.sample(now, {.acceleration = {tremor_, tremor_, 9.81 + tremor_}});
    if (!mute_) pty_.write(bytes);
    make_noise(100);
  }
  [[nodiscard]] NodeReport report() const override { return node_.report(); }

  simulate::devices::XsensEmulator device_;
  double tremor_ = 0;  // m/s^2
  ImuNode node_;
  serial::SerialLink link_;
};

TEST_F(ImuOnAPty, IsSetUpAndRead) {
  EXPECT_TRUE(run_until_more_samples(50));
  EXPECT_THAT(node_.report().faults, IsEmpty());
  EXPECT_EQ(node_.report().counters["garbage_bytes"], 0);
}

TEST_F(ImuOnAPty, IsReadAgainAfterItWasUnplugged) {
  ASSERT_TRUE(run_until_more_samples(20));
  pty_.unplug();
  ASSERT_TRUE(run_until_fault(pty_.path()));
  pty_.plug();
  pty_.write(device_.power_on(steady_clock()));
  EXPECT_TRUE(run_until_more_samples(50));
  EXPECT_TRUE(run_until_healthy());
  EXPECT_EQ(node_.report().counters["link.reopened"], 1);
}

TEST_F(ImuOnAPty, SilenceIsReportedAndEndsByItself) {
  ASSERT_TRUE(run_until_more_samples(20));
  mute_ = true;
  ASSERT_TRUE(run_until_fault("no sample from the IMU"));
  mute_ = false;
  EXPECT_TRUE(run_until_more_samples(20));
  EXPECT_TRUE(run_until_healthy());
}

TEST_F(ImuOnAPty, IsReadThroughNoise) {
  noise_ = true;
  EXPECT_TRUE(run_until_more_samples(100));
  EXPECT_GT(node_.report().counters["garbage_bytes"], 1000);
}

int status_of(const std::string& command) {
  FILE* output = popen((command + " 2>&1").c_str(), "r");
  char text[2000];
  while (output != nullptr && fread(text, 1, sizeof text, output) > 0) continue;
  return output != nullptr ? WEXITSTATUS(pclose(output)) : -1;
}

TEST(ImuProgram, WaitsForADeviceThatIsMissing) {
  EXPECT_EQ(status_of(test::kStoppedAfter + "3 " + test::program_path("curbstone-imu") +
                      " --lcm-url memq:// --set device=/dev/no_such_tty"),
            0)
      << "ended by the signal, cleanly";
}

TEST(ImuProgram, StopsWhereNoWaitingHelps) {
  const std::string program = test::program_path("curbstone-imu") + " --lcm-url memq:// --set ";
  EXPECT_EQ(status_of("timeout 60 " + program + "device=/dev/null"), 1);
  EXPECT_EQ(status_of("timeout 60 " + program + "devcie=/dev/ttyUSB0"), 2);
}

}  // namespace
}  // namespace curbstone::imu
