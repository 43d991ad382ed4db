#include "services/relay/relay_node.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <curbstone/imu_t.hpp>
#include <curbstone/map_points_t.hpp>
#include <functional>
#include <memory>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/time/clock.hpp"
#include "tests/services/relay/second_host.hpp"
#include "tests/stamps.hpp"

namespace curbstone::relay {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using test::kSecond;

std::unique_ptr<RelayNode> relay_to(const std::string& peers, const BusAddress& address, std::uint64_t run,
                                    const std::string& except = "") {
  RelayConfig config;
  config.peers = peers;
  config.except = except;
  return std::make_unique<RelayNode>(config, address, run);
}

/// A host's bus, as a process on it has it, and the host's relay.
struct Host {
  Host(const std::string& url, std::unique_ptr<RelayNode> its_relay) : bus(url), relay(std::move(its_relay)) {
    bus.subscribe<imu_t>("IMU", [this](const imu_t& m) { heard.push_back(m.sequence); });
    bus.subscribe<map_points_t>("MAP_POINTS", [this](const map_points_t& m) { points.push_back(m.num_points); });
  }
  void send(int sequence) {
    imu_t message{};
    message.sequence = sequence;
    bus.publish("IMU", message);
  }

  LcmBus bus;
  std::unique_ptr<RelayNode> relay;
  std::vector<int> heard;
  std::vector<int> points;
};

class RelayNodeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* url = std::getenv("CURBSTONE_TEST_URL");
    if (url == nullptr) GTEST_SKIP() << "CURBSTONE_TEST_URL not set: run through scripts/isolated";
    url_ = url;
    address_ = parse_bus_url(url).value();
    second_host_ = std::make_unique<SecondHost>();
  }
  void start_both(const std::string& peers_of_one, const std::string& except = "") {
    one_ = std::make_unique<Host>(url_, relay_to(peers_of_one, address_, 1, except));
    second_host_->run([&] { two_ = std::make_unique<Host>(url_, relay_to("192.168.2.1", address_, 2)); });
  }
  /// Both hosts work until `done`, 20 s at most.
  bool run_until(const std::function<bool()>& done) {
    const std::int64_t end = steady_clock() + 20 * kSecond;
    while (!done() && steady_clock() < end) {
      for (Host* host : {one_.get(), two_.get()}) {
        std::array<pollfd, 2> sockets = {{{host->relay->bus_fd(), POLLIN, 0}, {host->relay->peers_fd(), POLLIN, 0}}};
        poll(sockets.data(), sockets.size(), 5);
        if (sockets[0].revents != 0) host->relay->forward_to_peers();
        if (sockets[1].revents != 0) host->relay->forward_to_bus(now_);
        host->bus.handle(std::chrono::milliseconds(0));
      }
    }
    return done();
  }
  /// Time goes on by a second on both hosts.
  void tick() {
    now_ += kSecond;
    one_->relay->tick(now_);
    two_->relay->tick(now_);
  }

  std::string url_;
  BusAddress address_;
  std::unique_ptr<SecondHost> second_host_;
  std::unique_ptr<Host> one_;
  std::unique_ptr<Host> two_;
  std::int64_t now_ = 1'000 * kSecond;
};

TEST_F(RelayNodeTest, WhatOneHostSaysTheOtherHearsOnce) {
  start_both("192.168.2.2");
  one_->send(1);
  ASSERT_TRUE(run_until([&] { return !two_->heard.empty(); }));
  two_->send(2);
  ASSERT_TRUE(run_until([&] { return one_->heard.size() == 2; }));
  one_->send(3);  // behind all that could come twice
  ASSERT_TRUE(run_until([&] { return one_->heard.size() >= 3 && two_->heard.size() >= 3; }));
  EXPECT_THAT(one_->heard, ElementsAre(1, 2, 3));
  EXPECT_THAT(two_->heard, ElementsAre(1, 2, 3));
  EXPECT_EQ(one_->relay->report().counters["messages_out"], 2);
  EXPECT_EQ(one_->relay->report().counters["messages_in"], 1);
}

TEST_F(RelayNodeTest, TheLongestMessagesOfTheBusPass) {
  start_both("192.168.2.2");
  map_points_t message{};
  message.num_points = 6800;
  message.x.resize(6800), message.y.resize(6800), message.z.resize(6800), message.intensity.resize(6800);
  one_->bus.publish("MAP_POINTS", message);
  ASSERT_TRUE(run_until([&] { return !two_->points.empty(); }));
  EXPECT_THAT(two_->points, ElementsAre(6800));
}

TEST_F(RelayNodeTest, APulledCableCostsTheOwnBusNothing) {
  start_both("192.168.2.2");
  tick();
  one_->send(0);
  ASSERT_TRUE(run_until([&] { return !two_->heard.empty(); }));
  EXPECT_THAT(one_->relay->report().faults, IsEmpty());
  shell("ip link set cable0 down");
  for (int i = 1; i <= 200; ++i) {
    one_->send(i);
    two_->send(1000 + i);
    // One by one: a burst is more than a busy machine's buffers hold.
    const std::size_t sent = 1 + static_cast<std::size_t>(i);
    ASSERT_TRUE(run_until([&] { return one_->heard.size() == sent && two_->heard.size() == sent; })) << i;
  }
  for (int i = 0; i < 5; ++i) tick();
  ASSERT_TRUE(run_until([&] { return one_->relay->report().counters["dropped.peer"] == 200 + 5; }));
  EXPECT_THAT(one_->relay->report().faults,
              ElementsAre("the relay at 192.168.2.2:7720 is silent: nothing is exchanged with that host"));
  EXPECT_EQ(one_->bus.counters()["faults.publish"], 0);

  shell("ip link set cable0 up");
  // The cable is ready a moment later; what is said until then is lost.
  int said = 300;
  ASSERT_TRUE(run_until([&] {
    if (two_->heard.back() < 300 || two_->heard.back() >= 1000) one_->send(said++);
    return two_->heard.back() >= 300 && two_->heard.back() < 1000;
  }));
  ASSERT_TRUE(run_until([&] {
    tick();
    return one_->relay->report().faults.empty();
  }));
  EXPECT_GT(two_->relay->report().counters["lost.peer"], 0) << "the gap in the numbers";
}

TEST_F(RelayNodeTest, OneListOfHostsIsForAll) {
  start_both("192.168.2.1, 192.168.2.2");
  one_->send(1);
  ASSERT_TRUE(run_until([&] { return !two_->heard.empty(); }));
  one_->send(2);
  for (int i = 0; i < 5; ++i) tick();
  ASSERT_TRUE(run_until([&] { return one_->heard.size() >= 2 && two_->heard.size() >= 2; }));
  EXPECT_THAT(one_->heard, ElementsAre(1, 2)) << "it sends itself nothing";
  ASSERT_TRUE(run_until([&] { return one_->relay->report().faults.empty(); })) << "nor does it miss itself";
}

TEST_F(RelayNodeTest, SomeChannelsStayWhereTheyAre) {
  start_both("192.168.2.2", "MAP_POINTS, LIDAR_POINTS");
  one_->bus.publish("MAP_POINTS", map_points_t{});
  one_->send(1);
  ASSERT_TRUE(run_until([&] { return !two_->heard.empty() && !one_->points.empty(); }));
  EXPECT_THAT(two_->points, IsEmpty());
}

TEST_F(RelayNodeTest, WhoIsNoPeerIsRefused) {
  start_both("192.168.2.2");
  const int stranger = socket(AF_INET, SOCK_DGRAM, 0);  // on this host
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(7720);
  to.sin_addr.s_addr = inet_addr("192.168.2.1");
  const std::string bytes("CBR1............IMU\0data", 24);
  ASSERT_EQ(sendto(stranger, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to), 24);
  close(stranger);
  ASSERT_TRUE(run_until([&] { return one_->relay->report().counters["refused.datagram"] == 1; }));
  EXPECT_THAT(one_->heard, IsEmpty());
}

TEST_F(RelayNodeTest, APortThatIsTakenIsSaid) {
  const auto first = relay_to("192.168.2.2", address_, 1);
  try {
    const auto second = relay_to("192.168.2.2", address_, 2);
    FAIL() << "two relays on one port";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()), "UDP port 7720: Address already in use");
  }
}

}  // namespace
}  // namespace curbstone::relay
