#include <gmock/gmock.h>

#include <bit>

#include "common/bus/levels.hpp"
#include "tests/drivers/lidar/bench.hpp"
#include "tests/drivers/lidar/models/helios/helios_packets.hpp"
#include "tests/drivers/lidar/packets.hpp"
#include "tests/stamps.hpp"

namespace curbstone::lidar {
namespace {

using models::ModelName;
using models::rs16::DifopPacket;
using test::kStart;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kFirst = "device.serial_number.33C1160BAAA0";

DifopPacket rs16_info() {
  DifopPacket packet = info_packet();
  packet.serial_number = {0x33, 0xC1, 0x16, 0x0B, 0xAA, 0xA0};
  packet.firmware = {0x06, 0x23, 0x06, 0x06, 0xA0};
  packet.bottom_firmware = {0x08, 0x02, 0x09, 0x00, 0x00};
  return packet;
}

struct HealthBench : Bench {
  explicit HealthBench(ModelName model) : Bench(models::helios::config_for(model)) {}
  void send_info(const DifopPacket& packet) { send(std::bit_cast<models::rs16::Rs16Packet>(packet), kStart, 7788); }
  void send_info(const models::helios::Bytes& bytes) { send(bytes, kStart, 7788); }
  [[nodiscard]] std::vector<std::string> faults() const { return node.report().faults; }
};

TEST(DeviceHealth, SaysSerialNumberAndFirmwareOnceTwoAgree) {
  HealthBench bench(ModelName::kRs16);
  bench.send_info(rs16_info());
  EXPECT_EQ(bench.count(kFirst), 0);
  bench.send_info(rs16_info());
  EXPECT_EQ(bench.count(kFirst), 1);
  EXPECT_EQ(bench.count("device.firmware.06230606A0"), 1);
  EXPECT_EQ(bench.count("device.firmware_bottom.0802090000"), 1);
  const NodeReport report = bench.node.report();
  for (const auto& [name, value] : report.counters.values()) {
    if (name.starts_with("device.")) {
      EXPECT_TRUE(is_level(name)) << name;
    }
  }
}

TEST(DeviceHealth, OneDamagedInformationIsNoOtherDevice) {
  HealthBench bench(ModelName::kRs16);
  for (int i = 0; i < 2; ++i) bench.send_info(rs16_info());
  DifopPacket damaged = rs16_info();
  damaged.serial_number[2] = 0x17;
  bench.send_info(damaged);
  EXPECT_EQ(bench.count(kFirst), 1);
  EXPECT_EQ(bench.count("device.serial_number.33C1170BAAA0"), 0);
  bench.send_info(damaged);
  EXPECT_EQ(bench.count("device.serial_number.33C1170BAAA0"), 1) << "another device in its place";
  EXPECT_EQ(bench.count(kFirst), 0) << "and not both";
}

TEST(DeviceHealth, SaysThemOfAHeliosToo) {
  HealthBench bench(ModelName::kHelios16p);
  models::helios::Bytes info = models::helios::info(16);
  const models::helios::Bytes serial = {0x10, 0xBA, 0xC9, 0xD5, 0x0B, 0x05}, firmware = {0, 1, 5, 0, 9};
  std::copy(serial.begin(), serial.end(), info.begin() + 292);
  std::copy(firmware.begin(), firmware.end(), info.begin() + 40);
  for (int i = 0; i < 3; ++i) bench.send_info(info);
  EXPECT_EQ(bench.count("device.serial_number.10BAC9D50B05"), 1);
  EXPECT_EQ(bench.count("device.firmware.0001050009"), 1);
  EXPECT_EQ(bench.count("device.firmware_bottom.0000000000"), 1);
}

TEST(DeviceHealth, AWrongSpeedIsAFaultWhenTwoInARowSayIt) {
  HealthBench bench(ModelName::kRs16);
  DifopPacket good = rs16_info(), slow = rs16_info();
  good.rpm = slow.rpm = 1200;
  good.real_rpm = 6 * 1190;
  slow.real_rpm = 6 * 1100;
  for (int i = 0; i < 2; ++i) bench.send_info(good);
  bench.send_info(slow);
  EXPECT_THAT(bench.faults(), Not(Contains(HasSubstr("turns at")))) << "it may be damaged";
  bench.send_info(slow);
  EXPECT_THAT(bench.faults(), Contains(HasSubstr("turns at 1100 rpm and not at the 1200")));
  bench.send_info(good);
  EXPECT_THAT(bench.faults(), Not(Contains(HasSubstr("turns at"))));
}

TEST(DeviceHealth, ADeviceThatTellsNothingAnyMoreIsNotDescribedByItsLastWords) {
  HealthBench bench(ModelName::kRs16);
  DifopPacket slow = rs16_info();
  slow.rpm = 1200;
  slow.real_rpm = 6 * 1100;
  std::int64_t now = kStart;
  const auto pass = [&](int seconds) {
    for (int i = 0; i < 10 * seconds; ++i) bench.node.tick(now += 100'000);
  };
  for (int i = 0; i < 3; ++i) bench.send_info(slow);
  pass(4);
  EXPECT_THAT(bench.faults(), Contains(HasSubstr("turns at 1100 rpm")));
  EXPECT_EQ(bench.count("device.rpm"), 1100);
  pass(3);
  EXPECT_THAT(bench.faults(), Not(Contains(HasSubstr("turns at")))) << "it may stand by now";
  EXPECT_FALSE(bench.node.report().counters.values().contains("device.rpm"));
  bench.send_info(slow);
  pass(1);
  EXPECT_THAT(bench.faults(), Contains(HasSubstr("turns at 1100 rpm")));
  EXPECT_EQ(bench.count("device.rpm"), 1100);
}

TEST(DeviceHealth, AnErrorOfAVlp16sPpsIsForgottenWithItsPackets) {
  HealthBench bench(ModelName::kVlp16);
  models::helios::Bytes position(512);
  position[202] = 3;
  std::int64_t now = kStart;
  bench.send_info(position);
  for (int i = 0; i < 30; ++i) bench.node.tick(now += 100'000);
  EXPECT_THAT(bench.faults(), Contains(HasSubstr("PPS")));
  for (int i = 0; i < 40; ++i) bench.node.tick(now += 100'000);
  EXPECT_THAT(bench.faults(), Not(Contains(HasSubstr("PPS"))));
}

}  // namespace
}  // namespace curbstone::lidar
