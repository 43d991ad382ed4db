#pragma once

#include <gmock/gmock.h>

#include <cstring>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/lidar/models/robosense/packet_time.hpp"
#include "tests/drivers/lidar/bench.hpp"
#include "tests/paths.hpp"

namespace curbstone::lidar {

/// A real RS-LiDAR-16's packets (washing_house), for a test to put faults into.
class FaultyPackets : public ::testing::Test {
 protected:
  inline static const std::string kRecording = test::data_path("rs16/rs16_washing_house.pcap");
  static constexpr int kPackets = 3000;  ///< with points

  void SetUp() override {
    if (!std::filesystem::exists(kRecording)) GTEST_SKIP() << kRecording << " is not there";
    packets_ = recording(kRecording);
  }
  /// The `index`th point packet.
  RecordedPacket& point_packet(int index) {
    for (RecordedPacket& packet : packets_) {
      if (packet.port == models::robosense::kMsopPort && index-- == 0) return packet;
    }
    throw std::out_of_range("no such packet");
  }
  static void turn_azimuth(RecordedPacket& packet, std::size_t block, int by) {
    std::uint8_t* bytes = &packet.bytes[42 + 100 * block + 2];
    const int azimuth = (bytes[0] * 256 + bytes[1] + by + 36000) % 36000;
    bytes[0] = static_cast<std::uint8_t>(azimuth / 256);
    bytes[1] = static_cast<std::uint8_t>(azimuth % 256);
  }
  static std::int64_t stamp(const RecordedPacket& packet) {
    models::robosense::PacketTime time;
    std::memcpy(&time, &packet.bytes[20], sizeof time);
    return models::robosense::utime_from(time).value();
  }
  static void set_stamp(RecordedPacket& packet, std::int64_t utime) {
    const models::robosense::PacketTime time = models::robosense::packet_time_from(utime);
    std::memcpy(&packet.bytes[20], &time, sizeof time);
  }
  /// All device stamps moved so that the first packet's is `ahead` us ahead of its time of firing.
  void set_device_clock(std::int64_t ahead) {
    const std::int64_t by = point_packet(0).received - 1332 + ahead - stamp(point_packet(0));
    for (RecordedPacket& packet : packets_)
      if (packet.port == models::robosense::kMsopPort) set_stamp(packet, stamp(packet) + by);
  }
  void feed(Bench& bench) const {
    for (const RecordedPacket& packet : packets_) bench.send(packet.bytes, packet.received, packet.port);
    bench.finish();
  }
  /// What the undisturbed packets give.
  std::map<std::int64_t, lidar_points_t> undisturbed(const LidarConfig& config = {}) const {
    Bench bench(config);
    feed(bench);
    std::map<std::int64_t, lidar_points_t> by_time;
    for (const lidar_points_t& message : bench.points) by_time[message.utime] = message;
    return by_time;
  }
  /// Each message is one of the undisturbed ones, its stamp within 0.1 ms.
  static void expect_the_same(const Bench& bench, const std::map<std::int64_t, lidar_points_t>& truth) {
    std::int64_t last = 0;
    for (const lidar_points_t& message : bench.points) {
      ASSERT_GT(message.utime, last) << "in order";
      last = message.utime;
      const auto it = truth.lower_bound(message.utime - 100);
      ASSERT_TRUE(it != truth.end() && it->first <= message.utime + 100) << message.utime;
      ASSERT_TRUE(message.x == it->second.x && message.y == it->second.y) << message.packet;
      ASSERT_TRUE(message.time_offset == it->second.time_offset) << message.packet;
      EXPECT_EQ(message.revolution, it->second.revolution);
    }
  }

  std::vector<RecordedPacket> packets_;
};

}  // namespace curbstone::lidar
