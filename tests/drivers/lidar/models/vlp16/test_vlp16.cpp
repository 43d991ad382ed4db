#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "drivers/lidar/models/vlp16/vlp16_model.hpp"
#include "tests/drivers/lidar/bench.hpp"

namespace curbstone::lidar::models::vlp16 {
namespace {

using decoding::DecodedPacket;
using decoding::Refusal;
using ::testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

constexpr std::int64_t kReceived = 1'700'000'000'000'000;

void put16(Bytes& bytes, std::size_t at, int value) {
  bytes[at] = static_cast<std::uint8_t>(value & 0xFF);
  bytes[at + 1] = static_cast<std::uint8_t>(value >> 8);
}
void put32(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

/// A data packet without returns, its firings `step` (0.01 deg) apart.
Bytes data_packet(int azimuth, int step, std::uint8_t mode = kStrongest, std::uint32_t past_hour = 0) {
  Bytes bytes(kPacketSize);
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    const int firing = static_cast<int>(mode == kDual ? b / 2 : b);
    bytes[kBlockSize * b] = 0xFF;
    bytes[kBlockSize * b + 1] = 0xEE;
    put16(bytes, kBlockSize * b + 2, (azimuth + firing * step) % 36000);
  }
  put32(bytes, kStamp, past_hour);
  bytes[kReturnMode] = mode;
  bytes[1205] = 0x22;
  return bytes;
}
void put_record(Bytes& bytes, std::size_t block, std::size_t record, int distance, std::uint8_t reflectivity) {
  put16(bytes, kBlockSize * block + 4 + 3 * record, distance);
  bytes[kBlockSize * block + 6 + 3 * record] = reflectivity;
}

DecodedPacket decode(const Bytes& bytes, std::int64_t received = kReceived) {
  Vlp16Decoder decoder({0.0, 200.0}, {});
  DecodedPacket packet;
  EXPECT_EQ(decoder.decode(received, bytes, packet), Refusal::kNone);
  return packet;
}

// vlp16_helios16p.md, section 4: block 3 at 359.90, block 4 at 0.30 deg; 88 13 64 is 10.000 m, reflectivity 100.
TEST(Vlp16, PlacesPointsAsTheWorkedExample) {
  Bytes bytes = data_packet(35990 - 3 * 40, 40);
  EXPECT_EQ((Bytes{bytes.begin() + 300, bytes.begin() + 304}), (Bytes{0xFF, 0xEE, 0x96, 0x8C}));
  EXPECT_EQ((Bytes{bytes.begin() + 402, bytes.begin() + 404}), (Bytes{0x1E, 0x00}));
  for (const std::size_t record : {0U, 15U, 16U, 31U}) put_record(bytes, 3, record, 5000, 100);
  const DecodedPacket packet = decode(bytes);
  ASSERT_EQ(packet.x.size(), 4U);
  const double expected[4][4] = {{9.65924, 0.01686, -2.57699, 331.776},
                                 {9.65926, -0.00421, 2.57699, 366.336},
                                 {9.65924, -0.01686, -2.57699, 387.072},
                                 {9.65918, -0.03793, 2.57699, 421.632}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(packet.x[i], expected[i][0], 1e-5);
    EXPECT_NEAR(packet.y[i], expected[i][1], 1e-5);
    EXPECT_NEAR(packet.z[i], expected[i][2], 1e-5);
    EXPECT_NEAR(packet.time_offset[i], expected[i][3] * 1e-6, 1e-9);
    EXPECT_EQ(packet.intensity[i], 100);
  }
  EXPECT_EQ(packet.ring[0], 0);
  EXPECT_EQ(packet.ring[1], 15);
  EXPECT_NEAR(packet.duration, 1327.104e-6, 1e-9);
  EXPECT_EQ(packet.no_return, 380);
}

// The same section, the first packet of nebula's recording: two returns.
TEST(Vlp16, ReadsTwoReturnsAsThoseOfTheRealRecording) {
  Bytes bytes = data_packet(66, 39, kDual, 0x0860B14C);
  put_record(bytes, 0, 1, 477, 100);
  put_record(bytes, 1, 1, 477, 100);
  put_record(bytes, 4, 3, 3000, 20);  // the last return
  put_record(bytes, 5, 3, 1000, 50);  // the strongest
  const DecodedPacket packet = decode(bytes, 1'700'000'140'000'000 - 1'700'000'000'000'000 % 3'600'000'000);
  ASSERT_EQ(packet.x.size(), 3U) << "one return only: it is in both blocks, and goes out once";
  EXPECT_NEAR(packet.x[0], 0.95379, 1e-5);
  EXPECT_NEAR(packet.y[0], -0.01112, 1e-5);
  EXPECT_NEAR(packet.z[0], 0.01595, 1e-5);
  EXPECT_NEAR(static_cast<double>(*packet.stamp % 3'600'000'000) * 1e-6 + static_cast<double>(packet.time_offset[0]),
              140.554574, 1e-6);
  EXPECT_FLOAT_EQ(packet.time_offset[1], (2 * 110.592e-6F) + 3 * 2.304e-6F);
  EXPECT_FLOAT_EQ(packet.time_offset[2], packet.time_offset[1]);
  EXPECT_NEAR(packet.duration, 663.552e-6, 1e-9);
}

TEST(Vlp16, TakesItsStampToTheHourOfReceipt) {
  const std::int64_t hour = kReceived - kReceived % 3'600'000'000;
  EXPECT_EQ(decode(data_packet(0, 40, kLast, 1'000'000), hour + 1'002'000).stamp, hour + 1'000'000);
  EXPECT_EQ(decode(data_packet(0, 40, kLast, 3'599'999'000), hour + 1'000).stamp, hour - 1'000);
  EXPECT_EQ(decode(data_packet(0, 40, kLast, 500), hour - 200).stamp, hour + 500);
  EXPECT_FALSE(decode(data_packet(0, 40, kLast, 3'700'000'000), hour).stamp);
}

TEST(Vlp16, GoesOnThroughTheHourAlsoWithAClockThatIsHalfAnHourOff) {
  Vlp16Decoder decoder({0.0, 200.0}, {});
  DecodedPacket packet;
  const std::int64_t hour = kReceived - kReceived % 3'600'000'000;
  std::optional<std::int64_t> last;
  for (std::int64_t t = -10'000'000; t < 10'000'000; t += 1'327) {
    const std::int64_t past_hour = (t + 1'799'999'000 + 3'600'000'000) % 3'600'000'000;
    const std::int64_t received = hour + t + (t / 1'327 % 2 == 0 ? 0 : 3000);
    ASSERT_EQ(decoder.decode(received, data_packet(0, 40, kLast, static_cast<std::uint32_t>(past_hour)), packet),
              Refusal::kNone);
    if (last) {
      ASSERT_EQ(*packet.stamp - *last, 1'327);
    }
    last = packet.stamp;
  }
}

TEST(Vlp16, RefusesAndTellsWhy) {
  Vlp16Decoder decoder({0.0, 200.0}, {});
  DecodedPacket packet;
  const Bytes good = data_packet(0, 40);
  EXPECT_EQ(decoder.decode(0, std::span(good).first(1205), packet), Refusal::kLength);
  Bytes bad = good;
  bad[700] = 0;
  EXPECT_EQ(decoder.decode(0, bad, packet), Refusal::kBlock);
  bad = good;
  bad[1204] = 0x36;
  EXPECT_EQ(decoder.decode(0, bad, packet), Refusal::kMode);
  bad = good;
  put16(bad, 502, 36000);
  EXPECT_EQ(decoder.decode(0, bad, packet), Refusal::kAzimuth);
  bad = good;
  put16(bad, 2, 9000);
  EXPECT_EQ(decoder.decode(0, bad, packet), Refusal::kAzimuth) << "one wrong azimuth";
  bad = data_packet(0, 40, kDual);
  put16(bad, 302, 41);
  EXPECT_EQ(decoder.decode(0, bad, packet), Refusal::kAzimuth) << "a pair has one azimuth";
}

TEST(Vlp16, NamesEveryOtherVelodyne) {
  const std::pair<std::uint8_t, Sender> products[] = {{0x22, Sender::kVlp16},  {0x24, Sender::kPuckHiRes},
                                                      {0x21, Sender::kHdl32e}, {0x28, Sender::kVlp32c},
                                                      {0x63, Sender::kVls128}, {0x31, Sender::kVelodyne}};
  for (const auto& [byte, sender] : products) {
    Bytes bytes = data_packet(0, 40);
    bytes[1205] = byte;
    EXPECT_EQ(sender_of(bytes), sender);
  }
  Bytes hdl64 = data_packet(0, 40);
  hdl64[101] = 0xDD;
  EXPECT_EQ(sender_of(hdl64), Sender::kUnknown) << "one block: it is damaged";
  hdl64[301] = 0xDD;
  EXPECT_EQ(sender_of(hdl64), Sender::kHdl64e);
}

TEST(Vlp16, KnowsAValidGprmc) {
  const std::string text = "$GPRMC,081836,A,3751.65,S,14507.36,E,000.0,360.0,130998,011.3,E*62\r\n";
  EXPECT_TRUE(is_valid_gprmc(text));
  std::string bad = text;
  bad[14] = 'V';
  EXPECT_FALSE(is_valid_gprmc(bad)) << "not valid, and the checksum is wrong";
  EXPECT_FALSE(is_valid_gprmc(text.substr(0, text.size() - 5)));
  EXPECT_FALSE(is_valid_gprmc(""));
}

/// Packets of an undisturbed device with one return a laser at 10 m.
std::vector<Bytes> drive(int packets, std::int64_t from) {
  std::vector<Bytes> all;
  for (int i = 0; i < packets; ++i) {
    const std::int64_t at = from + i * 1'327'104LL / 1000;
    Bytes bytes = data_packet(i * 480 % 36000, 40, kStrongest, static_cast<std::uint32_t>(at % 3'600'000'000));
    for (std::size_t b = 0; b < 12; ++b)
      for (std::size_t r = 0; r < 32; ++r) put_record(bytes, b, r, 5000, 10);
    all.push_back(bytes);
  }
  return all;
}

TEST(Vlp16Node, SendsADriveAndRefusesFaultsByCause) {
  LidarConfig config;
  config.model = ModelName::kVlp16;
  Bench bench(config);
  auto packets = drive(1000, kReceived);
  put16(packets[300], 2, 9000);
  std::swap(packets[500], packets[501]);
  put32(packets[700], kStamp, static_cast<std::uint32_t>((kReceived + 700 * 1327 + 2'000'000) % 3'600'000'000));
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const auto received = kReceived + static_cast<std::int64_t>(i + 1) * 1'327'104 / 1000 + 100;
    bench.send(packets[i], received, kDataPort);
    if (i == 800) bench.send(packets[i], received, kDataPort);
  }
  bench.finish();
  EXPECT_EQ(bench.points.size(), 998U);
  EXPECT_EQ(bench.count("refused.azimuth"), 1);
  EXPECT_EQ(bench.count("refused.stamp"), 1);
  EXPECT_EQ(bench.count("refused.duplicate"), 1);
  EXPECT_EQ(bench.refused(), 3);
  EXPECT_EQ(bench.count("clock.device"), 1);
  std::int64_t last = 0;
  for (const lidar_points_t& message : bench.points) {
    ASSERT_GT(message.utime, last);
    last = message.utime;
    ASSERT_EQ(message.num_points, 384);
  }
  EXPECT_EQ(bench.points.back().revolution, (999 * 480 + 18000) / 36000);
}

TEST(Vlp16Node, TellsItsPpsAndGps) {
  LidarConfig config;
  config.model = ModelName::kVlp16;
  Bench bench(config);
  Bytes position(kPositionSize);
  position[202] = 2;
  const std::string text = "$GPRMC,081836,A,3751.65,S,14507.36,E,000.0,360.0,130998,011.3,E*62\r\n";
  std::copy(text.begin(), text.end(), position.begin() + 206);
  bench.send(position, kReceived, kPositionPort);
  EXPECT_EQ(bench.count("device.pps_locked"), 1);
  EXPECT_EQ(bench.count("device.gprmc_locked"), 1);
  position[202] = 3;
  bench.send(position, kReceived, kPositionPort);
  EXPECT_THAT(bench.node.report().faults, testing::Contains(HasSubstr("PPS")));
  position[202] = 9;
  bench.send(position, kReceived, kPositionPort);
  EXPECT_EQ(bench.count("refused.position"), 1);
}

TEST(Vlp16Node, RefusesOthersByName) {
  LidarConfig config;
  config.model = ModelName::kVlp16;
  Bench bench(config);
  Bytes hi_res = data_packet(0, 40);
  hi_res[1205] = 0x24;
  bench.send(hi_res, kReceived, 6699);
  EXPECT_EQ(bench.count("refused.puck_hi_res"), 1);
  bench.node.tick(kReceived);
  LidarConfig rs16;
  Bench other(rs16);
  other.send(data_packet(0, 40), kReceived, 6699);
  EXPECT_EQ(other.count("refused.vlp16"), 1);
}

TEST(Vlp16Node, SurvivesAnyBytes) {
  LidarConfig config;
  config.model = ModelName::kVlp16;
  Bench bench(config);
  std::mt19937 random(9);
  const auto packets = drive(100, kReceived);
  for (int i = 0; i < 5000; ++i) {
    Bytes bytes = packets[random() % packets.size()];
    if (i % 5 == 0) bytes.resize(random() % 1400);
    for (auto k = random() % 40; k > 0 && !bytes.empty(); --k)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    bench.send(bytes, kReceived + i * 1327LL, kDataPort);
  }
  for (const lidar_points_t& message : bench.points)
    ASSERT_TRUE(std::ranges::all_of(message.x, [](float x) { return std::isfinite(x); }));
}

TEST(AutoModel, IsDecidedByFivePacketsOfWhatItCanBe) {
  LidarConfig config;
  config.model = ModelName::kAuto;
  Bench bench(config);
  const auto packets = drive(20, kReceived);
  Bytes hi_res = data_packet(0, 40);
  hi_res[1205] = 0x24;
  std::size_t sent = 0;
  const auto send = [&](const Bytes& bytes) {
    bench.send(bytes, kReceived + static_cast<std::int64_t>(++sent) * 1'327'104 / 1000, kDataPort);
  };
  for (std::size_t i = 0; i < 4; ++i) send(packets[i]);
  send(hi_res);  // another device beside it, which no model of ours is
  EXPECT_EQ(bench.count("undecided"), 5);
  EXPECT_THAT(bench.node.report().faults, testing::Contains(HasSubstr("not decided yet")));
  for (std::size_t i = 4; i < 20; ++i) send(packets[i]);
  bench.finish();
  EXPECT_EQ(bench.count("undecided"), 5);
  EXPECT_EQ(bench.points.size(), 16U) << "the fifth decides, and is used";
  send(hi_res);
  EXPECT_EQ(bench.count("refused.puck_hi_res"), 1);
}

}  // namespace
}  // namespace curbstone::lidar::models::vlp16
