#include <gmock/gmock.h>

#include <random>

#include "tests/drivers/lidar/bench.hpp"
#include "tests/drivers/lidar/models/helios/helios_packets.hpp"
#include "tests/drivers/lidar/models/other_makers_packets.hpp"
#include "tests/drivers/lidar/packets.hpp"
#include "tests/stamps.hpp"

namespace curbstone::lidar::models {
namespace {

using test::kStart;
using ::testing::Contains;
using ::testing::HasSubstr;
using Bytes = OtherPacket;

constexpr ModelName kModels[] = {ModelName::kRs16, ModelName::kHelios16p, ModelName::kHelios32, ModelName::kVlp16};

TEST(OtherMakers, AreNamedByTheirWholeLayout) {
  for (const auto& [name, bytes] : other_makers_packets()) {
    const Sender sender = sender_of(bytes);
    EXPECT_EQ(std::string(counter_of(sender)), "refused." + name.substr(0, name.find(' '))) << name;
    EXPECT_FALSE(is_supported(sender));
  }
}

TEST(OtherMakers, AreRefusedByNameUnderEachModel) {
  for (const ModelName model : kModels) {
    for (const auto& [name, bytes] : other_makers_packets()) {
      Bench bench(helios::config_for(model));
      for (int i = 0; i < 20; ++i) bench.send(bytes, kStart + i * 1000);
      const std::string maker = name.substr(0, name.find(' '));
      EXPECT_EQ(bench.count(("refused." + maker).c_str()), 20) << name;
      EXPECT_EQ(bench.refused(), 20);
      EXPECT_THAT(bench.points, ::testing::IsEmpty());
    }
  }
}

TEST(OtherMakers, AreSaidWhereNothingElseComesToAuto) {
  Bench bench(helios::config_for(ModelName::kAuto));
  for (int i = 0; i < 20; ++i) bench.send(livox_packet(), kStart + i * 1000);
  EXPECT_EQ(bench.count("undecided"), 20);
  EXPECT_THAT(bench.node.report().faults, Contains(HasSubstr("the last packets are from a Livox LiDAR")));
}

TEST(OtherMakers, DoNotKeepAutoFromFindingTheDeviceBesideThem) {
  Bench bench(helios::config_for(ModelName::kAuto));
  const auto packets = drive_packets(kStart, 50);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const std::int64_t now = kStart + static_cast<std::int64_t>(i + 1) * 1332;
    bench.send(packets[i], now);
    bench.send(hesai_xt_packet(), now);
    EXPECT_EQ(bench.node.role_of_packet(hesai_xt_packet()), sources::OneSender::Kind::kForeign);
  }
  EXPECT_EQ(bench.points.size(), 46U);
  EXPECT_EQ(bench.count("refused.hesai"), 46) << "the first four came before the model was known";
}

TEST(OtherMakers, AreNotNamedWhereAnythingDoesNotFit) {
  for (const auto& [name, whole] : other_makers_packets()) {
    Bytes bytes = whole;
    bytes.pop_back();
    const bool by_length = !name.starts_with("hesai XT") && !name.starts_with("hesai 128");
    if (by_length) {
      EXPECT_EQ(sender_of(bytes), Sender::kUnknown) << name << " that is cut off";
    }
    bytes = whole;
    for (std::size_t i = 0; i < 12; ++i) bytes[i] = 0x77;
    EXPECT_EQ(sender_of(bytes), Sender::kUnknown) << name << " with another beginning";
  }
  Bytes gap = ouster_packet(true, 64, 12);
  gap[32 + 5 * (12 + 64 * 12) + 8] ^= 0x40;
  EXPECT_EQ(sender_of(gap), Sender::kUnknown) << "columns that are not numbered";
}

TEST(OtherMakers, AreNotNamedInNoise) {
  std::mt19937 random(5);
  for (int i = 0; i < 3000; ++i) {
    Bytes bytes(i % 3 == 0 ? 1318 : i % 3 == 1 ? 6464 : random() % 2000);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    EXPECT_FALSE(is_supported(sender_of(bytes)));
    EXPECT_EQ(sender_of(bytes), Sender::kUnknown) << i;
  }
}

}  // namespace
}  // namespace curbstone::lidar::models
