// Against the kernel's CAN, on the virtual interface vcan0. Where there is none, can_in_qemu runs this program inside a
// small virtual machine that has it.
#include <gmock/gmock.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <curbstone/wheels_t.hpp>
#include <fstream>

#include "common/time/clock.hpp"
#include "drivers/encoder/can/candump.hpp"
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

TEST_F(SocketCanTest, IdsOf29BitsAreAskedForByTheirMark) {
  CanSocket a(kInterface, {0x000});
  CanSocket b(kInterface, {0x8000'0181});
  CanFrame extended = CanFrame::make(0x181, {1});
  extended.extended = true;
  ASSERT_TRUE(a.write(CanFrame::make(0x181, {3})));
  ASSERT_TRUE(a.write(extended));
  EXPECT_EQ(wait_and_read(b).frame, extended);
  EXPECT_EQ(b.read().status, CanSocket::Status::kNothing);
}

TEST_F(SocketCanTest, TheKernelSaysWhyAnInterfaceCannotBeRestarted) {
  EXPECT_THAT(restart_can(kInterface), HasSubstr("not supported")) << "a virtual bus is never off";
  EXPECT_THAT(restart_can("no_can9"), HasSubstr("no such interface"));
}

TEST_F(SocketCanTest, AnInterfaceThatIsDownIsToldWithTheCommandThatMendsIt) {
  set_up(false);
  EXPECT_THAT(error_of(kInterface), HasSubstr("it is down; `ip link set vcan0 up"));
  set_up(true);
  EXPECT_EQ(error_of(kInterface), "");
}

/// The driver as the program runs it and an emulated drive, both on vcan0, in real time.
class EncoderOnSocketCan : public SocketCanTest {
 public:
  /// Ends with the test.
  class Command {
   public:
    explicit Command(const std::string& command) : pipe_(popen(("exec " + command + " 2>&1").c_str(), "r")) {}
    ~Command() { pclose(pipe_); }
    Command(const Command&) = delete;
    Command& operator=(const Command&) = delete;

   private:
    FILE* pipe_;
  };

 protected:
  void SetUp() override {
    SocketCanTest::SetUp();
    if (IsSkipped()) return;
    open_bus();
    link_.emplace(kInterface, can_ids(config_), [this](const std::string&) { return restart(); });
    node_.emplace(config_, recorder_.bus(), [this](const CanFrame& frame) { link_->send(frame); });
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
    for (const CanFrame& frame : frames) {
      if (drive_on_) bus_->write(frame);
    }
  }
  /// The drive keeps its own time: what it would have sent while this machine was busy has the counts of then.
  void turn_drive() {
    const std::int64_t now = steady_clock();
    for (auto due = drive_.next_due(); due && *due <= now; due = drive_.next_due()) {
      set_counts(*due);
      send(drive_.tick(*due));
    }
    set_counts(now);  // a start sends at once
    for (auto read = bus_->read(); read.status == CanSocket::Status::kFrame; read = bus_->read()) {
      send(drive_.on_frame(now, read.frame));
    }
  }
  void set_counts(std::int64_t at) {
    const auto counts = static_cast<std::int32_t>((at - start_) / 100);  // 10,000 counts/s
    drive_.set_counts(counts, -counts);
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

  /// What a controller's driver tells of its errors.
  void send_error(canid_t bits) {
    const int fd = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(kInterface));
    ASSERT_EQ(bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    can_frame frame{};
    frame.can_id = CAN_ERR_FLAG | bits;
    frame.can_dlc = CAN_ERR_DLC;
    ASSERT_EQ(write(fd, &frame, sizeof frame), static_cast<ssize_t>(sizeof frame));
    close(fd);
  }
  std::string restart() {
    restarts_.push_back(steady_clock());
    return why_no_restart_;
  }
  bool run_until_fault(const std::string& text) {
    return run_until([&] {
      for (const auto& fault : node_->report().faults) {
        if (fault.find(text) != std::string::npos) return true;
      }
      return false;
    });
  }

  EncoderConfig config_;
  std::vector<std::int64_t> restarts_;
  std::string why_no_restart_;
  bool drive_on_ = true;
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

TEST_F(EncoderOnSocketCan, BusErrorsAreCountedAndABusOffIsAFaultAndRestartedUntilFramesCome) {
  ASSERT_TRUE(run_until_more_samples(20));
  send_error(CAN_ERR_BUSERROR);
  send_error(CAN_ERR_CRTL);
  ASSERT_TRUE(run_until([&] { return node_->report().counters["can.errors"] == 2; }));
  EXPECT_EQ(node_->report().counters["can.bus_off"], 0);

  drive_on_ = false;
  why_no_restart_ = "not today";
  send_error(CAN_ERR_BUSOFF);
  ASSERT_TRUE(run_until_fault("vcan0 is bus-off: cable, terminator or bit rate; it cannot be restarted: not today"));
  ASSERT_TRUE(run_until([&] { return restarts_.size() == 4; }));
  EXPECT_GE(restarts_[1] - restarts_[0], 190'000);
  EXPECT_GE(restarts_[2] - restarts_[1], 390'000);
  EXPECT_GE(restarts_[3] - restarts_[2], 790'000);
  why_no_restart_ = "";
  ASSERT_TRUE(run_until([&] { return node_->report().counters["can.restarts"] >= 1; }));
  send_error(CAN_ERR_RESTARTED);
  drive_on_ = true;
  EXPECT_TRUE(run_until_more_samples(20));
  EXPECT_TRUE(run_until([&] { return node_->report().faults.empty(); }));
  const std::size_t restarts = restarts_.size();
  EXPECT_TRUE(run_until_more_samples(50));
  EXPECT_EQ(restarts_.size(), restarts) << "the bus is on";
  EXPECT_EQ(node_->report().counters["can.bus_off"], 1);
  EXPECT_EQ(node_->report().counters["can.restart_failed"], 4);
}

TEST_F(EncoderOnSocketCan, TheNoiseOfOthersChangesNothing) {
  if (std::system("command -v cangen >/dev/null") != 0) GTEST_SKIP() << "no cangen: can-utils has it";
  ASSERT_TRUE(run_until_more_samples(20));
  const std::int64_t setups = node_->report().counters["drive.setups"];
  const Command extended(std::string("timeout -s KILL 4 cangen ") + kInterface + " -e -g 1");
  const Command standard(std::string("timeout -s KILL 4 cangen ") + kInterface + " -I 3FF -g 1");
  const std::size_t before = recorder_.messages().size();
  ASSERT_TRUE(run_until_more_samples(250));
  const Counters counters = node_->report().counters;
  EXPECT_EQ(counters["refused.length"], 0);
  EXPECT_EQ(counters["refused.jump"], 0);
  EXPECT_EQ(counters["ignored.frames"], 0);
  EXPECT_EQ(counters["drive.setups"], setups);
  const auto& messages = recorder_.messages();
  const double seconds = static_cast<double>(messages.back().utime - messages[before].utime) * 1e-6;
  EXPECT_NEAR(static_cast<double>(messages.back().counts[0] - messages[before].counts[0]) / seconds, 10'000, 1'000);
}

TEST_F(EncoderOnSocketCan, NonsenseOnTheDrivesOwnIdsIsNeverPublished) {
  if (std::system("command -v cangen >/dev/null") != 0) GTEST_SKIP() << "no cangen: can-utils has it";
  ASSERT_TRUE(run_until_more_samples(50));
  {
    const Command positions(std::string("timeout -s KILL 3 cangen ") + kInterface + " -I 181 -g 20");
    const Command sdo(std::string("timeout -s KILL 3 cangen ") + kInterface + " -I 581 -g 20");
    EXPECT_TRUE(run_until([&] {
      const Counters counters = node_->report().counters;
      return counters["refused.jump"] > 20 && counters["refused.length"] > 20 && counters["ignored.sdo"] > 20;
    }));
    EXPECT_TRUE(run_until_fault("of the packets of a second were refused"));
  }
  EXPECT_TRUE(run_until_more_samples(100));
  for (const wheels_t& message : recorder_.messages()) ASSERT_LE(std::abs(message.speed[0]), 61);
  EXPECT_TRUE(run_until([&] { return node_->report().faults.empty(); }));
}

/// The first frames of a real car, played by canplayer at their own pace.
class RealLogOnSocketCan : public EncoderOnSocketCan {
 protected:
  static constexpr const char* kLog = "/data/fsae_candump.log";
  void SetUp() override {
    config_.configure = false;
    config_.signals = {SignalKind::kCounts, "202 0|8@1+", "202 8|8@1+"};
    drive_on_ = false;
    EncoderOnSocketCan::SetUp();
  }
};

TEST_F(RealLogOnSocketCan, EachFrameThatWasAskedForIsRead) {
  if (std::system("command -v canplayer >/dev/null") != 0) GTEST_SKIP() << "no canplayer: can-utils has it";
  std::ifstream log(kLog);
  if (!log) GTEST_SKIP() << kLog << " is not there: can_in_qemu brings it";
  std::vector<CanFrame> played;
  for (std::string text; std::getline(log, text);) {
    const auto line = parse_candump_line(text);
    if (line && line->frame.id == 0x202) played.push_back(line->frame);
  }
  ASSERT_GT(played.size(), 1000u);
  CanSocket other(kInterface, {0x202});  // hears the same
  std::vector<CanFrame> heard;
  loop_.every(5ms, [&] {
    for (auto read = other.read(); read.status == CanSocket::Status::kFrame; read = other.read())
      heard.push_back(read.frame);
  });
  const Command player(std::string("canplayer vcan0=can0 -I ") + kLog);
  EXPECT_TRUE(run_until([&] { return heard.size() >= played.size(); }));
  EXPECT_TRUE(heard == played) << heard.size() << " of " << played.size();
  EXPECT_TRUE(run_until([&] {
    return node_->report().counters["can.frames"] == static_cast<std::int64_t>(played.size());
  })) << node_->report().counters["can.frames"]
      << " of " << played.size();
  EXPECT_EQ(node_->report().counters["refused.length"], 0);
}

}  // namespace
}  // namespace curbstone::encoder::can
