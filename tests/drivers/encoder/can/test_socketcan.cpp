// Against the kernel's CAN, on the virtual interface vcan0. Where there is none, can_in_qemu runs this program inside a
// small virtual machine that has it.
#include <gmock/gmock.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <curbstone/wheels_t.hpp>

#include "common/time/clock.hpp"
#include "drivers/encoder/can/socketcan_link.hpp"
#include "drivers/encoder/encoder_node.hpp"
#include "tests/drivers/recorder.hpp"
#include "tools/simulate/devices/can_drive_emulator.hpp"

namespace curbstone::encoder::can {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const char* const kInterface = "vcan0";

std::string error_of(const std::string& interface) {
  try {
    const CanSocket socket(interface, {0x181});
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

void set_up(bool up) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq request{};
  std::string(kInterface).copy(request.ifr_name, IFNAMSIZ - 1);
  ioctl(fd, SIOCGIFFLAGS, &request);
  request.ifr_flags = static_cast<short>(up ? request.ifr_flags | IFF_UP : request.ifr_flags & ~IFF_UP);
  ioctl(fd, SIOCSIFFLAGS, &request);
  close(fd);
}

CanSocket::Read wait_and_read(CanSocket& socket) {
  for (int i = 0; i < 1000; ++i) {
    const CanSocket::Read read = socket.read();
    if (read.status != CanSocket::Status::kNothing) return read;
    usleep(1000);
  }
  return {};
}

class SocketCanTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (if_nametoindex(kInterface) == 0) GTEST_SKIP() << "no interface vcan0 here: can_in_qemu runs these tests";
  }
};

TEST(SocketCanErrors, SayWhatIsMissing) {
  EXPECT_THAT(error_of("no_can9"), ::testing::AnyOf(HasSubstr("this kernel has no CAN: use slcan"),
                                                    HasSubstr("cannot open CAN interface no_can9: there is no such")));
}

TEST_F(SocketCanTest, FramesOfEveryKindGoThroughUnchangedAndAreStampedByTheKernel) {
  CanSocket a(kInterface, {0x000});
  CanSocket b(kInterface, {0x181, 0x7FF});
  CanFrame frame = CanFrame::make(0x181, {1, 2, 3, 4, 5, 6, 7, 0xFF});
  const std::int64_t before = wall_clock();
  for (int size = 0; size <= 8; ++size) {
    frame.size = static_cast<std::uint8_t>(size);
    std::fill(frame.data.begin() + size, frame.data.end(), std::uint8_t{0});
    ASSERT_TRUE(a.write(frame));
    const auto read = wait_and_read(b);
    ASSERT_EQ(read.status, CanSocket::Status::kFrame);
    EXPECT_EQ(read.frame, frame);
    EXPECT_GE(read.utime, before);
    EXPECT_LE(read.utime, wall_clock());
    frame = CanFrame::make(0x181, {1, 2, 3, 4, 5, 6, 7, 0xFF});
  }
  CanFrame remote;
  remote.id = 0x7FF;
  remote.remote = true;
  remote.size = 2;
  ASSERT_TRUE(a.write(remote));
  EXPECT_EQ(wait_and_read(b).frame, remote);
}

TEST_F(SocketCanTest, OnlyTheIdsAskedForArriveAndNoExtendedOnesOfTheSameNumber) {
  CanSocket a(kInterface, {0x000});
  CanSocket b(kInterface, {0x181});
  CanFrame extended = CanFrame::make(0x181, {1});
  extended.extended = true;
  ASSERT_TRUE(a.write(extended));
  ASSERT_TRUE(a.write(CanFrame::make(0x182, {2})));
  ASSERT_TRUE(a.write(CanFrame::make(0x181, {3})));
  EXPECT_EQ(wait_and_read(b).frame, CanFrame::make(0x181, {3}));
  EXPECT_EQ(b.read().status, CanSocket::Status::kNothing);
}

TEST_F(SocketCanTest, AnInterfaceThatIsDownIsToldWithTheCommandThatMendsIt) {
  set_up(false);
  EXPECT_THAT(error_of(kInterface), HasSubstr("it is down; `ip link set vcan0 up"));
  set_up(true);
  EXPECT_EQ(error_of(kInterface), "");
}

/// The driver as the program runs it and an emulated drive, both on vcan0, in real time.
class EncoderOnSocketCan : public SocketCanTest {
 protected:
  void SetUp() override {
    SocketCanTest::SetUp();
    if (IsSkipped()) return;
    open_bus();
    link_.emplace(kInterface, canopen::WheelDrive::ids(1));
    node_.emplace(EncoderConfig{}, recorder_.bus(), [this](const CanFrame& frame) { link_->send(frame); });
    node_->add_report([this](NodeReport& report) { link_->report(report); });
    link_->attach(loop_, {[this](auto utime, const auto& frame) { node_->on_frame(utime, frame); },
                          [this](auto now, bool up, const auto& why) { node_->on_link(now, up, why); }});
    loop_.every(20ms, [this] { node_->tick(wall_clock()); });
    loop_.every(2ms, [this] { turn_drive(); });
    start_ = steady_clock();
    send(drive_.power_on(start_));
  }
  void open_bus() { bus_.emplace(kInterface, std::vector<std::uint32_t>{0x000, 0x601}); }
  void send(const simulate::devices::CanDriveEmulator::Frames& frames) {
    for (const CanFrame& frame : frames) bus_->write(frame);
  }
  void turn_drive() {
    const std::int64_t now = steady_clock();
    const auto counts = static_cast<std::int32_t>((now - start_) / 100);  // 10,000 counts/s
    drive_.set_counts(counts, -counts);
    for (auto read = bus_->read(); read.status == CanSocket::Status::kFrame; read = bus_->read()) {
      send(drive_.on_frame(now, read.frame));
    }
    send(drive_.tick(now));
  }
  bool run_until(const std::function<bool()>& done) {
    const std::int64_t deadline = steady_clock() + 20'000'000;
    bool reached = false;
    done_ = [&] {
      reached = done();
      if (reached || steady_clock() > deadline) loop_.stop();
    };
    if (!watching_) loop_.every(10ms, [this] { done_(); });
    watching_ = true;
    loop_.run();
    return reached;
  }
  bool run_until_more_samples(std::size_t more) {
    const std::size_t before = recorder_.messages().size();
    return run_until([&] { return recorder_.messages().size() >= before + more; });
  }

  EventLoop loop_;
  std::optional<CanSocket> bus_;
  simulate::devices::CanDriveEmulator drive_;
  std::int64_t start_ = 0;
  bool watching_ = false;
  std::function<void()> done_;
  testing::Recorder<wheels_t> recorder_{"WHEELS"};
  std::optional<SocketCanLink> link_;
  std::optional<EncoderNode> node_;
};

TEST_F(EncoderOnSocketCan, TheDriveIsSetUpAndTheWheelsAreRead) {
  ASSERT_TRUE(run_until_more_samples(100));
  EXPECT_TRUE(run_until([&] { return node_->report().faults.empty(); }));
  const Counters counters = node_->report().counters;
  EXPECT_GE(counters["drive.setups"], 1);
  EXPECT_EQ(counters["can.errors"], 0);
  EXPECT_EQ(counters["ignored.frames"], 0);
  const auto& messages = recorder_.messages();
  const wheels_t& first = messages[messages.size() - 50];
  const wheels_t& last = messages.back();
  const double seconds = static_cast<double>(last.utime - first.utime) * 1e-6;
  EXPECT_NEAR(static_cast<double>(last.counts[0] - first.counts[0]) / seconds, 10'000, 1'000);
  EXPECT_NEAR(static_cast<double>(last.counts[1] - first.counts[1]) / seconds, 10'000, 1'000);
}

TEST_F(SocketCanTest, AnInterfaceThatIsMissingAtTheStartIsWaitedFor) {
  set_up(false);
  EventLoop loop;
  std::vector<std::string> faults;
  bool is_up = false;
  SocketCanLink link(kInterface, {0x181});
  link.attach(loop, {[](auto, const auto&) {},
                     [&](auto, bool up, const auto& why) {
                       is_up = up;
                       if (!up) faults.push_back(why);
                       if (faults.size() == 2) set_up(true);
                       if (up) loop.stop();
                     }});
  const std::int64_t deadline = steady_clock() + 20'000'000;
  loop.every(10ms, [&] {
    if (steady_clock() > deadline) loop.stop();
  });
  loop.run();
  EXPECT_TRUE(is_up);
  ASSERT_GE(faults.size(), 2u);
  EXPECT_THAT(faults[0], HasSubstr("it is down"));
}

TEST_F(EncoderOnSocketCan, AnInterfaceThatGoesDownIsAFaultUntilItIsUpAgain) {
  ASSERT_TRUE(run_until_more_samples(20));
  set_up(false);
  EXPECT_TRUE(run_until([&] {
    const auto faults = node_->report().faults;
    return !faults.empty() && faults[0].find("vcan0") != std::string::npos;
  }));
  set_up(true);
  open_bus();
  EXPECT_TRUE(run_until_more_samples(50));
  EXPECT_TRUE(run_until([&] { return node_->report().faults.empty(); }));
  EXPECT_EQ(node_->report().counters["link.reopened"], 1);
}

}  // namespace
}  // namespace curbstone::encoder::can
