#include "common/bus/local_bus.hpp"

#include <gtest/gtest.h>

#include <curbstone/imu_t.hpp>
#include <curbstone/map_points_t.hpp>

namespace curbstone {
namespace {

TEST(LocalBus, DeliversInOrderOfPublicationIncludingWhatHandlersPublish) {
  LocalBus bus;
  std::vector<std::string> order;
  bus.subscribe<imu_t>("A", [&](const imu_t& m) {
    order.push_back("A" + std::to_string(m.sequence));
    bus.publish("B", m);
  });
  bus.subscribe<imu_t>("B", [&](const imu_t& m) { order.push_back("B" + std::to_string(m.sequence)); });
  imu_t message{};
  message.sequence = 1;
  bus.publish("A", message);
  message.sequence = 2;
  bus.publish("A", message);
  EXPECT_TRUE(order.empty());
  bus.dispatch();
  EXPECT_EQ(order, (std::vector<std::string>{"A1", "A2", "B1", "B2"}));
}

TEST(LocalBus, AnEndedSubscriptionHearsNothingMoreAndOthersDo) {
  LocalBus bus;
  int first = 0;
  int second = 0;
  const SubscriptionId id = bus.subscribe<imu_t>("A", [&](const imu_t&) { ++first; });
  const SubscriptionId other = bus.subscribe<imu_t>("A", [&](const imu_t&) { ++second; });
  bus.publish("A", imu_t{});
  bus.unsubscribe(id);
  bus.dispatch();
  EXPECT_EQ(first, 0) << "not even what was published before";
  EXPECT_EQ(second, 1);
  bus.publish("A", imu_t{});
  bus.unsubscribe(other);
  bus.unsubscribe(other);
  bus.dispatch();
  EXPECT_EQ(second, 1);
  EXPECT_FALSE(bus.hears("A"));
}

TEST(LocalBus, CountsWhatDoesNotDecode) {
  LocalBus bus;
  bus.subscribe<imu_t>("A", [](const imu_t&) { FAIL(); });
  bus.inject("A", "garbage", 7);
  bus.dispatch();
  EXPECT_EQ(bus.counters()["refused.undecodable"], 1);
}

TEST(LocalBus, RefusesAnArrayLongerThanItsMessage) {
  map_points_t good{};
  good.num_points = 1;
  good.x = good.y = good.z = {0};
  good.intensity = {0};
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(good.getEncodedSize()));
  good.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  constexpr std::size_t kNumPoints = 8 + 8 + 4 + 4 + 4 + 4 + 4;  // behind fingerprint, utime ... first
  ASSERT_EQ(bytes[kNumPoints + 3], 1);
  LocalBus bus;
  bus.subscribe<map_points_t>("A", [](const map_points_t&) { FAIL(); });
  for (const int high_byte : {0x40, 0x7f, 0x80, 0xff, 0x01}) {
    bytes[kNumPoints] = static_cast<std::uint8_t>(high_byte);
    bus.inject("A", bytes.data(), static_cast<int>(bytes.size()));
  }
  bus.dispatch();
  EXPECT_EQ(bus.counters()["refused.undecodable"], 5);
}

}  // namespace
}  // namespace curbstone
