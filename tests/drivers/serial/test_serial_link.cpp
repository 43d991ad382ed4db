#include "drivers/serial/serial_link.hpp"

#include <gmock/gmock.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <functional>
#include <thread>
#include <utility>

#include "common/time/clock.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/pty.hpp"

namespace {
std::function<void()> before_the_next_read;
}

/// Stands before libc's: what happens to a process that the scheduler stops on its way into the kernel.
extern "C" ssize_t read(int fd, void* buffer, size_t size) {
  if (const auto happens = std::exchange(before_the_next_read, nullptr)) happens();
  return syscall(SYS_read, fd, buffer, size);
}

namespace curbstone::serial {
namespace {

using namespace std::chrono_literals;
using test::Bytes;

TEST(SerialLinkTest, ComesBackByItselfAfterTheDeviceWasUnplugged) {
  test::Pty pty;
  EventLoop loop;
  SerialLink link({pty.path(), 115200});
  std::vector<std::string> story;
  test::Bytes received;
  link.attach(loop, {[&](std::int64_t, auto bytes) { received.insert(received.end(), bytes.begin(), bytes.end()); },
                     [&](std::int64_t, link::LinkState state, const std::string& why) {
                       const bool up = state == link::LinkState::kUp;
                       if (up || why.find("vanished") != std::string::npos) story.push_back(up ? "up" : "vanished");
                     }});
  int step = 0;
  loop.every(50ms, [&] {
    ++step;
    if (step == 1) pty.write(test::Bytes{1, 2});
    if (step == 3) pty.unplug();
    if (step == 8) pty.plug();
    if (step > 8 && story.size() == 2) {
      pty.write(test::Bytes{3});
      if (received.size() >= 3) loop.stop();
    }
    if (step == 200) loop.stop();
  });
  loop.run();
  EXPECT_THAT(story, ::testing::ElementsAre("vanished", "up"));
  ASSERT_GE(received.size(), 3u);
  EXPECT_EQ(received[0], 1);
  EXPECT_EQ(received[2], 3);
  link.send(test::Bytes{9});
  EXPECT_EQ(pty.wait_and_read(), test::Bytes{9});
}

TEST(SerialLinkTest, ADeviceThatIsMissingAtTheStartIsAFaultUntilItComes) {
  test::Pty pty;
  const std::string path = pty.path();
  pty.unplug();
  EventLoop loop;
  SerialLink link({path, 115200});
  std::vector<std::string> down;
  test::Bytes received;
  bool up = false;
  link.attach(loop, {[&](std::int64_t, auto bytes) { received.insert(received.end(), bytes.begin(), bytes.end()); },
                     [&](std::int64_t, link::LinkState state, const std::string& why) {
                       up = state == link::LinkState::kUp;
                       if (!up) down.push_back(why);
                     }});
  ASSERT_EQ(down.size(), 1u) << "reported at once";
  EXPECT_THAT(down[0], ::testing::HasSubstr(path));
  link.send(test::Bytes{1});
  int step = 0;
  loop.every(50ms, [&] {
    if (++step == 8) pty.plug();
    if (up && received.empty()) pty.write(test::Bytes{7});
    if (!received.empty() || step == 200) loop.stop();
  });
  loop.run();
  EXPECT_TRUE(up);
  ASSERT_FALSE(received.empty());
  EXPECT_GT(down.size(), 1u) << "reported again with each try";
  NodeReport report;
  link.report(report);
  EXPECT_EQ(report.counters["dropped.serial_away"], 1);
  EXPECT_EQ(report.counters["serial.baud"], 115200);
  EXPECT_EQ(report.counters["serial.low_latency_refused"], 1);
}

TEST(SerialLinkTest, AFileThatIsNoSerialPortEndsTheStart) {
  EXPECT_THROW(SerialLink({"/dev/null", 115200}), NotASerialPort);
}

TEST(SerialLinkTest, WhatTheKernelDoesNotTakeAtOnceIsSentInOrderAndWhole) {
  test::Pty pty;
  EventLoop loop;
  SerialLink link({pty.path(), 115200});
  link.attach(loop, {[](std::int64_t, std::span<const std::uint8_t>) {},
                     [](std::int64_t, link::LinkState, const std::string&) {}});
  constexpr std::size_t kSize = 100;
  int sent = 0;
  const auto dropped = [&] {
    NodeReport report;
    link.report(report);
    return report.counters["dropped.serial_full"];
  };
  while (dropped() < 3 && sent < 100'000) link.send(test::Bytes(kSize, static_cast<std::uint8_t>(sent++)));
  ASSERT_EQ(dropped(), 3) << "what waits is bounded";
  const std::size_t expected = static_cast<std::size_t>(sent - 3) * kSize;
  test::Bytes received;
  int step = 0;
  loop.every(1ms, [&] {
    const auto bytes = pty.read();
    received.insert(received.end(), bytes.begin(), bytes.end());
    if (received.size() >= expected || ++step == 5000) loop.stop();
  });
  loop.run();
  ASSERT_EQ(received.size(), expected);
  for (std::size_t i = 0; i < expected; ++i) ASSERT_EQ(received[i], static_cast<std::uint8_t>(i / kSize)) << i;
  link.send(test::Bytes{9});
  EXPECT_EQ(pty.wait_and_read(), test::Bytes{9});
}

TEST(SerialLinkTest, NothingIsReceivedBeforeItWasSentHoweverBusyTheHost) {
  test::Pty pty;
  EventLoop loop;
  SerialLink link({pty.path(), 115200});
  std::int64_t sent = 0, received = 0;
  link.attach(loop, {[&](std::int64_t utime, std::span<const std::uint8_t> bytes) {
                       if (bytes.back() != 2) return;
                       received = utime;
                       loop.stop();
                     },
                     [](std::int64_t, link::LinkState, const std::string&) {}});
  before_the_next_read = [&] {
    std::this_thread::sleep_for(20ms);
    sent = wall_clock();
    pty.write(test::Bytes{2});
  };
  pty.write(test::Bytes{1});
  loop.run();
  EXPECT_GE(received, sent);
}

TEST(SerialLinkTest, WhatIsSentWhileTheDeviceIsAwayIsLostWithoutHarm) {
  test::Pty pty;
  EventLoop loop;
  SerialLink link({pty.path(), 115200});
  bool vanished = false, back = false;
  link.attach(loop, {[](std::int64_t, std::span<const std::uint8_t>) {},
                     [&](std::int64_t, link::LinkState state, const std::string&) {
                       const bool up = state == link::LinkState::kUp;
                       (up ? back : vanished) = true;
                       if (up) loop.stop();
                     }});
  pty.unplug();
  link.send(test::Bytes(100'000, 7));  // the link does not know yet
  int step = 0;
  loop.every(20ms, [&] {
    if (vanished && pty.fd() < 0) {
      link.send(test::Bytes(100'000, 7));
      pty.plug();
    }
    if (++step == 500) loop.stop();
  });
  loop.run();
  ASSERT_TRUE(vanished && back);
  link.send(test::Bytes{9});
  EXPECT_EQ(pty.wait_and_read(), test::Bytes{9}) << "and nothing of what was sent meanwhile";
}

}  // namespace
}  // namespace curbstone::serial
