#include "common/local_bus.hpp"

#include <gtest/gtest.h>

#include <curbstone/imu_t.hpp>

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

TEST(LocalBus, CountsWhatDoesNotDecode) {
  LocalBus bus;
  bus.subscribe<imu_t>("A", [](const imu_t&) { FAIL(); });
  bus.inject("A", "garbage", 7);
  bus.dispatch();
  EXPECT_EQ(bus.counters()["refused.undecodable"], 1);
}

}  // namespace
}  // namespace curbstone
