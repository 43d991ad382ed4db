#include "drivers/encoder/can/socketcan_link.hpp"

#include <gmock/gmock.h>

#include "tests/drivers/encoder/can/on_vcan.hpp"

namespace curbstone::encoder::can {
namespace {

using ::testing::HasSubstr;

std::string error_of(const std::string& interface) {
  try {
    const CanSocket socket(interface, {0x181});
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

CanSocket::Read wait_and_read(CanSocket& socket) {
  for (int i = 0; i < 1000; ++i) {
    const CanSocket::Read read = socket.read();
    if (read.status != CanSocket::Status::kNothing) return read;
    usleep(1000);
  }
  return {};
}

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

TEST_F(SocketCanTest, AnInterfaceThatIsDownIsReportedWithTheCommandThatMendsIt) {
  set_up(false);
  EXPECT_THAT(error_of(kInterface), HasSubstr("it is down; `ip link set vcan0 up"));
  set_up(true);
  EXPECT_EQ(error_of(kInterface), "");
}

TEST_F(SocketCanTest, AnInterfaceThatIsMissingAtTheStartIsWaitedFor) {
  set_up(false);
  EventLoop loop;
  std::vector<std::string> faults;
  bool is_up = false;
  SocketCanLink link(kInterface, {0x181});
  link.attach(loop, {[](auto, const auto&) {},
                     [&](auto, link::LinkState state, const auto& why) {
                       is_up = state == link::LinkState::kUp;
                       if (!is_up) faults.push_back(why);
                       if (faults.size() == 2) set_up(true);
                       if (is_up) loop.stop();
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

}  // namespace
}  // namespace curbstone::encoder::can
