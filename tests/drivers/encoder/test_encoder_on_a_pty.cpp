#include <gmock/gmock.h>
#include <sys/wait.h>

#include <curbstone/wheels_t.hpp>

#include "common/time/clock.hpp"
#include "drivers/encoder/can/slcan_link.hpp"
#include "drivers/encoder/encoder_node.hpp"
#include "tests/drivers/driver_on_a_pty.hpp"
#include "tests/drivers/stopped_after.hpp"
#include "tests/paths.hpp"
#include "tools/simulate/devices/can_drive_emulator.hpp"
#include "tools/simulate/devices/slcan_emulator.hpp"

namespace curbstone::encoder {
namespace {

using namespace std::chrono_literals;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The driver as the program runs it, and an emulated drive behind an emulated adapter, at the two ends of a
/// pseudo-terminal, in real time.
class EncoderOnAPty : public test::DriverOnAPty<wheels_t> {
 protected:
  EncoderOnAPty()
      : DriverOnAPty("WHEELS"),
        link_({pty_.path(), 115200}, 500),
        node_(EncoderConfig{}, recorder_.bus(), [this](const can::CanFrame& frame) { link_.send(frame); }) {
    node_.add_report([this](NodeReport& report) { link_.report(report); });
    link_.attach(loop_, {[this](auto utime, const auto& frame) { node_.on_frame(utime, frame); },
                         [this](auto now, auto state, const auto& why) { node_.on_link(now, state, why); }});
    loop_.every(20ms, [this] { node_.tick(wall_clock()); });
    loop_.every(2ms, [this] { turn_devices(); });
    start_ = steady_clock();
    to_host(drive_.power_on(start_));
  }

  void to_host(const simulate::devices::CanDriveEmulator::Frames& frames) {
    for (const can::CanFrame& frame : frames) {
      if (!mute_) pty_.write(adapter_.on_frame(frame));
    }
  }
  void turn_devices() {
    const std::int64_t now = steady_clock();
    const auto turn_wheels = [this](std::int64_t at) {
      const auto counts = static_cast<std::int32_t>((at - start_) / 100);  // 10,000 counts/s
      drive_.set_counts(counts, -counts);
    };
    turn_wheels(now);
    const auto result = adapter_.on_bytes(pty_.read());
    pty_.write(result.to_host);
    for (const can::CanFrame& frame : result.to_bus) to_host(drive_.on_frame(now, frame));
    // A busy host comes late to what is due, by as many samples as it likes: each has the counts of its own time.
    for (auto due = drive_.next_due(); due && *due <= now; due = drive_.next_due()) {
      turn_wheels(*due);
      to_host(drive_.tick(*due));
    }
    make_noise(20);
  }
  [[nodiscard]] NodeReport report() const override { return node_.report(); }

  simulate::devices::SlcanEmulator adapter_;
  simulate::devices::CanDriveEmulator drive_;
  std::int64_t start_ = 0;
  can::SlcanLink link_;
  EncoderNode node_;
};

TEST_F(EncoderOnAPty, TheAdapterIsOpenedTheDriveSetUpAndTheWheelsAreRead) {
  ASSERT_TRUE(run_until_more_samples(100));
  EXPECT_TRUE(run_until_healthy());
  EXPECT_EQ(node_.report().counters["drive.setups"], 1);
  EXPECT_EQ(node_.report().counters["refused.slcan_line"], 0);
  const auto& messages = recorder_.messages();
  const wheels_t& first = messages[messages.size() - 50];
  const wheels_t& last = messages.back();
  const double seconds = static_cast<double>(last.utime - first.utime) * 1e-6;
  EXPECT_NEAR(static_cast<double>(last.counts[0] - first.counts[0]) / seconds, 10'000, 1'000);
  EXPECT_NEAR(static_cast<double>(last.counts[1] - first.counts[1]) / seconds, 10'000, 1'000);
}

TEST_F(EncoderOnAPty, IsReadAgainAfterTheAdapterWasUnplugged) {
  ASSERT_TRUE(run_until_more_samples(20));
  pty_.unplug();
  ASSERT_TRUE(run_until_fault(pty_.path()));
  adapter_.reset();
  pty_.plug();
  EXPECT_TRUE(run_until_more_samples(50));
  EXPECT_TRUE(run_until_healthy());
}

TEST_F(EncoderOnAPty, AnAdapterThatForgotItsChannelIsOpenedAgain) {
  ASSERT_TRUE(run_until_more_samples(20));
  adapter_.reset();
  ASSERT_TRUE(run_until_fault("no positions from the drive"));
  EXPECT_TRUE(run_until_more_samples(50));
  EXPECT_TRUE(run_until_healthy());
}

TEST_F(EncoderOnAPty, ADriveThatLosesPowerIsReportedAndSetUpAgain) {
  ASSERT_TRUE(run_until_more_samples(20));
  mute_ = true;
  ASSERT_TRUE(run_until_fault("no positions from the drive"));
  mute_ = false;
  to_host(drive_.power_on(steady_clock()));
  EXPECT_TRUE(run_until_more_samples(50));
  EXPECT_TRUE(run_until_healthy());
}

TEST_F(EncoderOnAPty, ErrorFlagsOfTheAdapterAreCountedAndAreAFaultUntilTheyAreGone) {
  ASSERT_TRUE(run_until_more_samples(20));
  adapter_.set_flags(0x80 | 0x20 | 0x40);
  ASSERT_TRUE(run_until_fault("the SLCAN adapter reports bus error, error passive"));
  EXPECT_EQ(node_.report().counters["slcan.bus_error"], 1);
  EXPECT_EQ(node_.report().counters["slcan.arbitration_lost"], 1);
  EXPECT_TRUE(run_until_healthy());
}

TEST_F(EncoderOnAPty, IsReadThroughNoise) {
  ASSERT_TRUE(run_until_more_samples(20));
  noise_ = true;
  EXPECT_TRUE(run_until_more_samples(20));
  const Counters counters = node_.report().counters;
  EXPECT_GT(counters["refused.slcan_line"] + counters["refused.slcan_overlong"], 15);
  noise_ = false;
  EXPECT_TRUE(run_until_more_samples(50));
  EXPECT_TRUE(run_until_healthy());
}

TEST(EncoderProgram, SaysInOneLineWhatIsMissingAndStops) {
  struct Missing {
    const char* what;
    int exit_status;  // 2: no waiting mends it
  };
  for (const auto& [what, exit_status] :
       {Missing{"device=/dev/null", 1}, Missing{"interface=socketcan --set device=/dev/can0", 1},
        Missing{"interface=modbus_tcp --set modbus.host=nowhere", 2},
        Missing{"interface=modbus_rtu --set baud=128000", 2}}) {
    const std::string command =
        test::program_path("curbstone-encoder") + " --lcm-url memq:// --set " + what + " 2>&1 >/dev/null";
    FILE* output = popen(command.c_str(), "r");
    ASSERT_NE(output, nullptr);
    std::string text(2000, '\0');
    text.resize(fread(text.data(), 1, text.size(), output));
    EXPECT_EQ(WEXITSTATUS(pclose(output)), exit_status) << what;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
    EXPECT_THAT(text, AnyOf(HasSubstr("cannot open"), HasSubstr("is no serial port"), HasSubstr("encoder.")));
  }
}

TEST(EncoderProgram, ADeviceThatIsMissingAtTheStartIsWaitedFor) {
  for (const char* what : {"interface=slcan --set device=/dev/no_such_tty",
                           "interface=modbus_rtu --set device=/dev/no_such_tty --set baud=115200",
                           "interface=modbus_tcp --set modbus.host=127.0.0.1 --set modbus.port=1"}) {
    const std::string command = test::kStoppedAfter + ("1.5 " + test::program_path("curbstone-encoder")) +
                                " --lcm-url memq:// --set " + what + " 2>&1";
    FILE* output = popen(command.c_str(), "r");
    ASSERT_NE(output, nullptr);
    std::string text(2000, '\0');
    text.resize(fread(text.data(), 1, text.size(), output));
    EXPECT_EQ(WEXITSTATUS(pclose(output)), 0) << what << "\n" << text;
    EXPECT_EQ(text, "") << what;
  }
}

}  // namespace
}  // namespace curbstone::encoder
