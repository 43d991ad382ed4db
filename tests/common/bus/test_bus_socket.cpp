#include "common/bus/socket/bus_socket.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <cstdlib>
#include <curbstone/imu_t.hpp>
#include <string>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/time/clock.hpp"

namespace curbstone {
namespace {

/// In a network namespace of its own; see scripts/isolated.
class BusSocketTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* url = std::getenv("CURBSTONE_TEST_URL");
    if (url == nullptr) GTEST_SKIP() << "CURBSTONE_TEST_URL not set: run through scripts/isolated";
    url_ = url;
    address_ = parse_bus_url(url_).value();
  }
  /// The channels of what comes, until so many have come or patience is at its end. Loopback may deliver late.
  static std::vector<std::string> receive(BusSocket& socket, std::size_t wanted) {
    std::vector<std::string> channels;
    const std::int64_t end = steady_clock() + 10'000'000;
    while (channels.size() < wanted && steady_clock() < end) {
      pollfd waiting{socket.fd(), POLLIN, 0};
      poll(&waiting, 1, 100);
      socket.receive([&](const BusSocket::Message& message) { channels.emplace_back(message.channel); });
    }
    return channels;
  }
  std::string url_;
  BusAddress address_;
};

TEST_F(BusSocketTest, HearsNothingUntilItSubscribes) {
  BusSocket socket(address_);
  BusSocket witness(address_);
  witness.pass_all();
  LcmBus sender(url_);
  sender.publish("IMU", imu_t{});
  receive(witness, 1);
  socket.pass_only({"IMU", "LAST"});
  for (const char* channel : {"IMU", "IMU2", "LAST"}) sender.publish(channel, imu_t{});
  EXPECT_EQ(receive(socket, 2), (std::vector<std::string>{"IMU", "LAST"}));
}

TEST_F(BusSocketTest, HandsOverChannelBytesAndTheKernelsTime) {
  BusSocket socket(address_);
  socket.pass_all();
  LcmBus sender(url_);
  imu_t sent{};
  sent.sequence = 4711;
  const std::int64_t before = wall_clock();
  sender.publish("IMU", sent);
  int count = 0;
  pollfd waiting{socket.fd(), POLLIN, 0};
  poll(&waiting, 1, 10'000);
  socket.receive([&](const BusSocket::Message& message) {
    ++count;
    EXPECT_EQ(message.channel, "IMU");
    imu_t received{};
    EXPECT_EQ(received.decode(message.bytes.data(), 0, static_cast<int>(message.bytes.size())),
              static_cast<int>(message.bytes.size()));
    EXPECT_EQ(received.sequence, 4711);
    EXPECT_GE(message.utime, before);
    EXPECT_LE(message.utime, wall_clock());
  });
  EXPECT_EQ(count, 1);
}

TEST_F(BusSocketTest, HearsOnlyItsOwnGroupOfThePort) {
  BusSocket socket(address_);
  socket.pass_all();
  BusAddress other = address_;
  other.group = "239.255.76.68";
  LcmBus stranger("udpm://" + other.group + ":" + std::to_string(other.port) + "?ttl=0");
  BusSocket listener(other);
  listener.pass_all();
  stranger.publish("OF_ANOTHER", imu_t{});
  EXPECT_EQ(receive(listener, 1), std::vector<std::string>{"OF_ANOTHER"});
  LcmBus(url_).publish("OWN", imu_t{});
  EXPECT_EQ(receive(socket, 1), std::vector<std::string>{"OWN"});
}

TEST_F(BusSocketTest, ADropIsCountedByTheSocketThatWasFullAndByNoOther) {
  BusSocket slow(address_);
  BusSocket quick(address_);
  if (address_.buffer < 1'000'000) GTEST_SKIP() << "the buffer asked for is too small to tell";
  slow.pass_only({"LARGE"});
  quick.pass_only({"LARGE"});
  LcmBus sender(url_);
  struct Large {
    [[nodiscard]] int getEncodedSize() const { return 40'000; }
    int encode(void* data, int, int) const {
      std::fill_n(static_cast<char*>(data), 40'000, 'x');
      return 40'000;
    }
  };
  constexpr int kSent = 600;  // 24 MB: more than any buffer here
  for (int i = 0; i < kSent; ++i) {
    sender.publish("LARGE", Large{});
    ASSERT_EQ(receive(quick, 1).size(), 1U);
  }
  EXPECT_EQ(quick.dropped(), 0);
  const std::int64_t dropped = slow.dropped();
  EXPECT_GT(dropped, 0);
  const auto left = static_cast<std::int64_t>(receive(slow, static_cast<std::size_t>(kSent - dropped)).size());
  EXPECT_EQ(left + dropped, kSent);
  EXPECT_EQ(slow.dropped(), dropped) << "counted once";
}

TEST_F(BusSocketTest, WhatIsNoWholeMessageIsRefusedAndCounted) {
  BusSocket socket(address_);
  socket.pass_all();
  LcmBus sender(url_);
  struct Huge {  // LCM sends it in fragments
    [[nodiscard]] int getEncodedSize() const { return 100'000; }
    int encode(void*, int, int) const { return 100'000; }
  };
  sender.publish("HUGE", Huge{});
  sender.publish("IMU", imu_t{});
  EXPECT_EQ(receive(socket, 1), std::vector<std::string>{"IMU"});
  EXPECT_EQ(socket.refused(), 2) << "two fragments";
  EXPECT_EQ(socket.dropped(), 0);
}

}  // namespace
}  // namespace curbstone
