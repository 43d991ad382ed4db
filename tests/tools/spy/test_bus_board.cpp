#include "tools/spy/board/bus_board.hpp"

#include <gmock/gmock.h>

#include <curbstone/imu_t.hpp>
#include <random>

#include "tests/stamps.hpp"
#include "tests/tools/spy/encoded.hpp"

namespace curbstone::spy::board {
namespace {

using test::kStart;

void receive(BusBoard& board, const std::string& channel, const std::vector<std::uint8_t>& bytes, std::int64_t now) {
  board.on_message(channel, bytes.data(), bytes.size(), now);
}

imu_t sample(int sequence) {
  imu_t imu{};
  imu.sequence = sequence;
  return imu;
}

TEST(BusBoard, KnowsTheTypeAndTheLossesOfAChannel) {
  BusBoard board("");
  for (const int sequence : {1, 2, 5}) receive(board, "IMU", encoded(sample(sequence)), kStart + sequence * 10'000);
  const ChannelState& imu = board.channels().at("IMU");
  EXPECT_EQ(imu.type, "curbstone.imu_t");
  EXPECT_EQ(imu.statistics.lost(), 2);
  EXPECT_EQ(imu.undecodable, 0);
  EXPECT_TRUE(imu.last.empty()) << "nobody follows it";
}

TEST(BusBoard, WhatCannotBeDecodedIsCounted) {
  BusBoard board("");
  receive(board, "A", {1, 2, 3}, kStart);
  auto cut = encoded(sample(1));
  cut.resize(20);
  receive(board, "IMU", cut, kStart);
  auto status = encoded(status_of("ekf", 0));
  status.resize(status.size() - 1);
  receive(board, "SERVICE_STATUS", status, kStart);
  EXPECT_EQ(board.channels().at("A").undecodable, 1);
  EXPECT_EQ(board.channels().at("IMU").undecodable, 1);
  EXPECT_EQ(board.channels().at("SERVICE_STATUS").undecodable, 1);
  EXPECT_TRUE(board.services().services().empty());
}

TEST(BusBoard, AServicesRatesAreThoseBetweenTwoStatuses) {
  BusBoard board("");
  service_status_t status = status_of("ekf", 1'000'000);
  status.cpu_time = 500'000;
  set_counters(status, {{"dropped.queue", 10}, {"lost.packets", 1}, {"refused.late", 7}, {"samples", 1000}});
  receive(board, "SERVICE_STATUS", encoded(status), kStart);
  status.uptime = 3'000'000;
  status.cpu_time = 700'000;
  set_counters(status, {{"dropped.queue", 20}, {"lost.packets", 5}, {"refused.late", 7}, {"samples", 2000}});
  receive(board, "SERVICE_STATUS", encoded(status), kStart + 2'000'000);
  const ServiceState& ekf = board.services().services().at({"ekf", "ugv"});
  EXPECT_DOUBLE_EQ(ekf.cpu, 0.1);
  EXPECT_DOUBLE_EQ(ekf.dropped, 7);
  EXPECT_DOUBLE_EQ(ekf.refused, 0);
  EXPECT_EQ(ekf.counter("samples"), 2000);
  EXPECT_FALSE(ekf.counter("other"));
  EXPECT_FALSE(ekf.is_silent(kStart + 4'000'000));
  EXPECT_TRUE(ekf.is_silent(kStart + 6'000'000));
}

TEST(BusBoard, ADeputysClockIsItsStampMinusItsArrival) {
  BusBoard board("");
  procman_lcm::deputy_info_t info{};
  info.utime = kStart + 80'000;
  info.deputy_id = "ugv";
  receive(board, "PM_INFO", encoded(info), kStart);
  EXPECT_EQ(board.deputies().at("ugv").clock, 80'000);
}

TEST(BusBoard, AnyBytesMayComeAndMemoryIsBounded) {
  BusBoard board("FOLLOWED");
  std::mt19937 random(1);
  const auto status = encoded(status_of("ekf", 1'000'000));
  for (int k = 0; k < 20'000; ++k) {
    auto bytes = status;
    bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    receive(board, k % 3 == 0 ? "C" + std::to_string(k) : "SERVICE_STATUS", bytes, kStart + k);
  }
  EXPECT_LE(board.channels().size(), BusBoard::kMaxChannels);
  EXPECT_LE(board.services().services().size(), ServiceBoard::kMaxServices);
  EXPECT_GT(board.unlisted(), 0);
}

}  // namespace
}  // namespace curbstone::spy::board
