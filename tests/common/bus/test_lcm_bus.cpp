#include "common/bus/lcm_bus.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <lcm/lcm-cpp.hpp>

#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/raw_packet_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "tests/temporary_folder.hpp"

namespace curbstone {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 10s;  // for what takes milliseconds on an idle machine

/// Handles what comes until `done`, or patience is at its end.
template <class Done>
void handle_until(LcmBus& bus, const Done& done) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!done() && std::chrono::steady_clock::now() < deadline) bus.handle(10ms);
}

TEST(LcmBus, DeliversOverMemq) {
  LcmBus bus("memq://");
  int received = 0;
  bus.subscribe<imu_t>("IMU", [&](const imu_t& m) { received += m.sequence; });
  imu_t message{};
  message.sequence = 7;
  bus.publish("IMU", message);
  bus.publish("IMU2", message);  // exact names: not a prefix
  for (int i = 0; i < 4; ++i) bus.handle(10ms);
  EXPECT_EQ(received, 7);
}

TEST(LcmBus, AnEndedSubscriptionHearsNothingMoreOverMemq) {
  LcmBus bus("memq://");
  int imu = 0;
  const SubscriptionId id = bus.subscribe<imu_t>("IMU", [&](const imu_t&) { ++imu; });
  bus.unsubscribe(id);
  bus.publish("IMU", imu_t{});
  for (int i = 0; i < 4; ++i) bus.handle(10ms);
  EXPECT_EQ(imu, 0);
}

/// In a network namespace of its own; see scripts/isolated.
TEST(LcmBus, AnEndedSubscriptionHearsNothingMoreAndOthersDo) {
  const char* url = std::getenv("CURBSTONE_TEST_URL");
  if (url == nullptr) GTEST_SKIP() << "CURBSTONE_TEST_URL not set: run through scripts/isolated";
  LcmBus bus(url);
  int imu = 0;
  int wheels = 0;
  const SubscriptionId id = bus.subscribe<imu_t>("IMU", [&](const imu_t&) { ++imu; });
  bus.subscribe<wheels_t>("WHEELS", [&](const wheels_t&) { ++wheels; });
  LcmBus sender(url);
  const auto send = [&] {
    sender.publish("IMU", imu_t{});
    sender.publish("WHEELS", wheels_t{});
  };
  send();
  handle_until(bus, [&] { return imu == 1 && wheels == 1; });
  EXPECT_EQ(imu, 1);
  send();
  std::this_thread::sleep_for(200ms);  // they wait in the queue
  bus.unsubscribe(id);
  bus.unsubscribe(id);
  send();
  handle_until(bus, [&] { return wheels == 3; });
  EXPECT_EQ(wheels, 3);
  EXPECT_EQ(imu, 1);
  EXPECT_EQ(bus.counters()["dropped.queue"] + bus.counters()["dropped.kernel"], 0);
  bus.subscribe<imu_t>("IMU", [&](const imu_t&) { ++imu; });
  send();
  handle_until(bus, [&] { return imu == 2; });
  EXPECT_EQ(imu, 2) << "and again";
}

TEST(LcmBus, ATapSeesEveryChannelWithTheTimeOfItsMessages) {
  LcmBus bus("memq://");
  std::vector<std::string> channels;
  bus.tap(
      [&](const std::string& channel, const void*, int size, std::int64_t utime) {
        channels.push_back(channel);
        EXPECT_EQ(size, imu_t{}.getEncodedSize());
        EXPECT_GT(utime, 0);
      },
      {});
  bus.publish("IMU", imu_t{});
  bus.publish("A.B", imu_t{});
  for (int i = 0; i < 4; ++i) bus.handle(10ms);
  EXPECT_EQ(channels, (std::vector<std::string>{"IMU", "A.B"}));
}

TEST(LcmBus, ATapMayLeaveAChannelOut) {
  LcmBus bus("memq://");
  std::vector<std::string> channels;
  bus.tap([&](const std::string& channel, const void*, int, std::int64_t) { channels.push_back(channel); }, {}, "IMU");
  for (const char* channel : {"IMU", "IMU2", "A.IMU", "POSE"}) bus.publish(channel, imu_t{});
  for (int i = 0; i < 6; ++i) bus.handle(10ms);
  EXPECT_EQ(channels, (std::vector<std::string>{"IMU2", "A.IMU", "POSE"}));
}

/// Encoded bytes whose array length is negative: lcm-gen 1.3.1 throws on it.
struct Garbage {
  [[nodiscard]] int getEncodedSize() const { return 24; }
  int encode(void* data, int, int) const {
    auto* bytes = static_cast<std::uint8_t*>(data);
    std::uint64_t hash = static_cast<std::uint64_t>(lidar_points_t::getHash());
    for (int i = 7; i >= 0; --i, hash >>= 8) bytes[i] = static_cast<std::uint8_t>(hash);
    for (int i = 8; i < 24; ++i) bytes[i] = 0xFF;
    return 24;
  }
};

/// What ends a process that runs LCM 1.3.1 alone: a first fragment, and one whose offset lies far outside the message.
void send_deadly_fragments(const std::string& channel, std::uint16_t port) {
  using namespace std::string_literals;
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  inet_pton(AF_INET, "239.255.76.67", &to.sin_addr);
  const std::string first = "LC03\0\0\0\1\0\1\0\0\0\0\0\0\0\0\0\2"s + channel + '\0' + std::string(1000, 'x');
  const std::string second = "LC03\0\0\0\1\0\1\0\0\xFF\xFF\xFF\xF0\0\1\0\2"s + std::string(1000, 'x');
  const std::string no_end = "LC02\0\0\0\2"s + std::string(1000, 'A');
  for (int i = 0; i < 3; ++i) {
    for (const std::string& datagram : {first, second, no_end})
      (void)!sendto(fd, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
  close(fd);
}

TEST(LcmBus, LivesWithFragmentsThatLieOutsideTheirMessage) {
  constexpr const char* kUrl = "udpm://239.255.76.67:7681?ttl=0";
  LcmBus listener(kUrl);
  LcmBus recorder(kUrl);
  int heard = 0;
  int recorded = 0;
  listener.subscribe<imu_t>("IMU", [&](const imu_t&) { ++heard; });
  recorder.tap([&](const std::string&, const void*, int, std::int64_t) { ++recorded; }, {});
  send_deadly_fragments("IMU", 7681);
  LcmBus sender(kUrl);
  sender.publish("IMU", imu_t{});
  handle_until(listener, [&] { return heard > 0; });
  handle_until(recorder, [&] { return recorded > 0; });
  EXPECT_EQ(heard, 1);
  EXPECT_EQ(recorded, 1);
}

TEST(LcmBus, ATapHearsLargeMessagesOfTheChannelsThatItAskedFor) {
  constexpr const char* kUrl = "udpm://239.255.76.67:7682?ttl=0";
  LcmBus recorder(kUrl);
  recorder.receive_large({"CLOUD"});
  std::map<std::string, std::vector<std::uint8_t>> heard;
  recorder.tap(
      [&](const std::string& channel, const void* data, int size, std::int64_t) {
        const auto* bytes = static_cast<const std::uint8_t*>(data);
        heard[channel] = {bytes, bytes + size};
      },
      {});
  raw_packet_t cloud{};
  cloud.size = 120'000;  // what fits a stock kernel's buffer
  for (int i = 0; i < cloud.size; ++i) cloud.data.push_back(static_cast<std::uint8_t>(i * 7));
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(cloud.getEncodedSize()));
  cloud.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  LcmBus sender(kUrl);
  // Each message is sent once the one before has left the socket's buffer, which has room for one of this size; what
  // comes after it tells. However long a busy machine takes, only an overrun by others costs another try.
  const auto await_its_turn = [&] {
    heard.erase("IMU");
    sender.publish("IMU", imu_t{});
    for (int waits = 0; !heard.contains("IMU"); ++waits) {
      recorder.handle(20ms);
      if (waits % 50 == 49) sender.publish("IMU", imu_t{});
    }
  };
  for (int tries = 0; tries < 100 && !heard.contains("CLOUD"); ++tries) {
    sender.publish("OTHER", cloud);
    await_its_turn();
    sender.publish("CLOUD", cloud);
    await_its_turn();
  }
  EXPECT_EQ(heard["CLOUD"], bytes);
  EXPECT_FALSE(heard.contains("OTHER"));
  EXPECT_EQ(recorder.counters()["refused.fragment"], 0);
  handle_until(recorder, [&] { return heard.contains("IMU"); });
}

TEST(LcmBus, CountsWhatDoesNotDecodeAndHandlersThatThrow) {
  LcmBus bus("memq://");
  bus.subscribe<lidar_points_t>("LIDAR_POINTS", [](const lidar_points_t&) {});
  bus.subscribe<imu_t>("IMU", [](const imu_t&) { throw std::runtime_error("no"); });
  bus.publish("LIDAR_POINTS", Garbage{});
  bus.publish("IMU", imu_t{});
  for (int i = 0; i < 4; ++i) bus.handle(10ms);
  EXPECT_EQ(bus.counters()["refused.undecodable"], 1);
  EXPECT_EQ(bus.counters()["faults.handler"], 1);
}

TEST(LcmBus, BadUrlIsOneClearError) {
  try {
    LcmBus bus("nonsense://x");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("nonsense://x"), std::string::npos);
  }
}

TEST(LcmBus, ReadsBackALog) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "bus.lcmlog";
  {
    LcmBus out("file://" + file + "?mode=w");
    imu_t message{};
    for (message.sequence = 0; message.sequence < 5; ++message.sequence) out.publish("IMU", message);
  }
  LcmBus in("file://" + file + "?speed=0");
  std::vector<int> received;
  in.subscribe<imu_t>("IMU", [&](const imu_t& m) { received.push_back(m.sequence); });
  while (in.handle(100ms) && received.size() < 5) {
  }
  EXPECT_EQ(received, (std::vector<int>{0, 1, 2, 3, 4}));
}

/// In a network namespace of its own; see scripts/isolated.
TEST(LcmBus, SlowHandlerDropsOldestAndCounts) {
  const char* url = std::getenv("CURBSTONE_TEST_URL");
  if (url == nullptr) GTEST_SKIP() << "CURBSTONE_TEST_URL not set: run through scripts/isolated";
  LcmBus bus(url);
  std::vector<int> received;
  bus.subscribe<imu_t>("IMU", [&](const imu_t& m) { received.push_back(m.sequence); }, {.capacity = 10});
  LcmBus sender(url);
  imu_t message{};
  for (message.sequence = 0; message.sequence < 100; ++message.sequence) sender.publish("IMU", message);
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (bus.counters()["dropped.queue"] < 90 && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(1ms);
  bus.handle(0ms);
  ASSERT_EQ(received.size(), 10U);
  EXPECT_EQ(received.front(), 90);
  EXPECT_EQ(received.back(), 99);
  EXPECT_EQ(bus.counters()["dropped.queue"], 90);
}

/// Sends until the kernel has dropped something at the receiver's buffer, which is as small as it can be. `heard`: of
/// the two messages sent each time, how many are for the receiver.
void expect_drops_counted(LcmBus& bus, const std::string& url, const int& received, int heard) {
  LcmBus sender(url);
  int sent = 0;
  for (int burst = 0; burst < 50 && bus.counters()["dropped.kernel"] == 0; ++burst) {
    for (int i = 0; i < 500; ++i, ++sent) {
      sender.publish("IMU", imu_t{});
      sender.publish("IMU_OF_ANOTHER", imu_t{});
    }
    handle_until(bus, [&] { return received + bus.counters()["dropped.kernel"] >= heard * sent; });
  }
  EXPECT_GT(bus.counters()["dropped.kernel"], 0);
  EXPECT_EQ(bus.counters()["dropped.queue"], 0);
  EXPECT_EQ(received + bus.counters()["dropped.kernel"], heard * sent) << "what was dropped, no more and no less";
}

std::string with_smallest_buffer(std::string url) {
  const auto at = url.find("recv_buf_size=");
  return url.substr(0, at) + "recv_buf_size=2304";
}

TEST(LcmBus, SlowHandlersLeaveTimersTheirTurn) {
  LcmBus bus;
  int handled = 0;
  bus.subscribe<imu_t>("IMU", [&](const imu_t&) {
    ++handled;
    std::this_thread::sleep_for(10ms);
  });
  for (int i = 0; i < 300; ++i) bus.publish("IMU", imu_t{});
  std::this_thread::sleep_for(200ms);
  const auto begin = std::chrono::steady_clock::now();
  bus.handle(0ms);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 1s) << "all of them take 3 s";
  EXPECT_LT(handled, 100);
  pollfd waiting{bus.fd(), POLLIN, 0};
  EXPECT_EQ(poll(&waiting, 1, 0), 1) << "and are not forgotten";
  handle_until(bus, [&] { return handled == 300; });
  EXPECT_EQ(handled, 300);
}

TEST(LcmBus, CountsWhatTheKernelDropsAtAFullBuffer) {
  const char* url = std::getenv("CURBSTONE_TEST_URL");
  if (url == nullptr) GTEST_SKIP() << "CURBSTONE_TEST_URL not set: run through scripts/isolated";
  const std::string narrow = with_smallest_buffer(url);
  {
    LcmBus bus(narrow);
    int received = 0;
    bus.tap([&](const std::string&, const void*, int, std::int64_t) { ++received; }, {.capacity = 1'000'000});
    expect_drops_counted(bus, url, received, 2);
  }
  LcmBus bus(narrow);
  int received = 0;
  bus.subscribe<imu_t>("IMU", [&](const imu_t&) { ++received; }, {.capacity = 1'000'000});
  expect_drops_counted(bus, url, received, 1);
}

TEST(LcmBus, WhatNobodyHereHasSubscribedToIsNoLoss) {
  const char* url = std::getenv("CURBSTONE_TEST_URL");
  if (url == nullptr) GTEST_SKIP() << "CURBSTONE_TEST_URL not set: run through scripts/isolated";
  LcmBus bus(url);
  int imu = 0;
  int wheels = 0;
  bus.subscribe<imu_t>("IMU", [&](const imu_t&) { ++imu; });
  bus.subscribe<wheels_t>("WHEELS", [&](const wheels_t&) { ++wheels; });  // a second one does not shut out the first
  LcmBus sender(url);
  for (int i = 0; i < 50; ++i) {
    sender.publish("IMU", imu_t{});
    sender.publish("WHEELS", wheels_t{});
    sender.publish("IMU_OF_ANOTHER", imu_t{});
  }
  handle_until(bus, [&] { return imu >= 50 && wheels >= 50; });
  EXPECT_EQ(imu, 50);
  EXPECT_EQ(wheels, 50);
  EXPECT_EQ(bus.counters()["dropped.kernel"], 0);

  int all = 0;
  bus.tap([&](const std::string&, const void*, int, std::int64_t) { ++all; }, {.capacity = 1000});
  for (int i = 0; i < 50; ++i) sender.publish("IMU_OF_ANOTHER", imu_t{});
  handle_until(bus, [&] { return all >= 50; });
  EXPECT_EQ(all, 50) << "a tap sees all";
  EXPECT_EQ(bus.counters()["dropped.kernel"], 0) << "what was turned away before is no loss now";
}

}  // namespace
}  // namespace curbstone
