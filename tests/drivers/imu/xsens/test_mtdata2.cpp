#include "drivers/imu/xsens/mtdata2.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "common/geometry/geometry.hpp"
#include "drivers/imu/xsens/xbus_frame.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/paths.hpp"

namespace curbstone::imu::xsens {
namespace {

using test::append;
using test::Bytes;
using test::from_hex;
using ::testing::DoubleNear;
using ::testing::ElementsAre;

MtData2 decode(const std::string& hex, Counters* counters = nullptr) {
  Counters ignored;
  return decode_mtdata2(test::from_hex(hex), counters != nullptr ? *counters : ignored);
}

TEST(MtData2Test, ARealFrameGivesTheValuesThatItsRecordersSaw) {
  const test::Bytes wire = test::from_hex(
      "FA FF 36 62 10 20 02 A9 86 10 60 04 03 14 ED 53 10 10 0C 07 44 0B E0 07 E3 01 14 0D 2F 18 37 E0 20 04 01 80 00 "
      "07 "
      "40 20 0C BC 8E 54 66 C0 E8 2F 10 BF 9A D2 9E 40 10 0C B9 35 26 9F BD 94 99 30 BC 46 23 46 80 20 0C BB 42 5C 34 "
      "3B "
      "10 68 DF 3A E1 C7 E5 80 30 10 3F 80 00 01 B7 78 C7 F0 37 38 D8 27 37 10 7F EE F7");
  XbusParser parser;
  Counters counters;
  int frames = 0;
  parser.parse(0, wire, [&](const XbusFrame& frame) {
    ++frames;
    const MtData2 data = decode_mtdata2(frame.data, counters);
    EXPECT_EQ(data.packet_counter, 43398);
    EXPECT_EQ(data.sample_time_fine, 51'703'123u);
    EXPECT_EQ(data.status, 0x01800007u);
    EXPECT_THAT(*data.acceleration,
                ElementsAre(DoubleNear(-0.017374, 1e-6), DoubleNear(-7.255745, 1e-6), DoubleNear(-1.209553, 1e-6)));
    EXPECT_THAT(*data.angular_rate,
                ElementsAre(DoubleNear(-0.0029657, 1e-7), DoubleNear(0.0022035, 1e-7), DoubleNear(0.0017226, 1e-7)));
    EXPECT_THAT(*data.delta_velocity,
                ElementsAre(DoubleNear(-0.00017276, 1e-8), DoubleNear(-0.0725578, 1e-7), DoubleNear(-0.0120934, 1e-7)));
    EXPECT_THAT(*data.delta_rotation, ElementsAre(DoubleNear(1, 1e-6), DoubleNear(-1.4829e-5, 1e-9),
                                                  DoubleNear(1.1018e-5, 1e-9), DoubleNear(8.6129e-6, 1e-10)));
    EXPECT_FALSE(data.orientation);
    EXPECT_FALSE(data.temperature);
  });
  EXPECT_EQ(frames, 1);
  EXPECT_EQ(counters["skipped.items"], 1);  // UTC
}

TEST(MtData2Test, AllFourPrecisionsGiveTheirNumbers) {
  EXPECT_DOUBLE_EQ(*decode("08 10 04 41 C8 00 00").temperature, 25.0);
  EXPECT_NEAR(*decode("08 11 04 03 9A DF 03").temperature, 57.67944622, 1e-8);
  EXPECT_NEAR(*decode("08 12 06 AD F0 52 98 00 39").temperature, 57.67944828, 1e-8);
  EXPECT_NEAR(*decode("08 12 06 F6 3F CA F0 FF FF").temperature, -0.0380891, 1e-7);
  EXPECT_DOUBLE_EQ(*decode("08 13 08 40 39 00 00 00 00 00 00").temperature, 25.0);
}

TEST(MtData2Test, DenormalNumbersAreRefusedAndZeroIsNot) {
  Counters counters;
  EXPECT_FALSE(decode("40 20 0C 3F 80 00 00 00 00 00 01 41 1C E8 0A", &counters).acceleration);
  EXPECT_FALSE(decode("80 20 0C 80 7F FF FF 00 00 00 00 00 00 00 00", &counters).angular_rate);
  EXPECT_FALSE(decode("08 13 08 00 00 00 00 00 00 00 01", &counters).temperature);
  EXPECT_EQ(counters["refused.range"], 3);
  EXPECT_TRUE(decode("40 20 0C 80 00 00 00 00 00 00 00 00 80 00 00", &counters).acceleration) << "-0, 0, the least";
  EXPECT_EQ(counters["refused.range"], 3);
}

TEST(MtData2Test, CoordinateSystemAndPrecisionBitsAreNoPartOfTheType) {
  const std::string one_two_three = "0C 3F 80 00 00 40 00 00 00 40 40 00 00";
  for (const char* id : {"40 20 ", "40 24 ", "40 28 "}) {
    EXPECT_THAT(*decode(id + one_two_three).acceleration, ElementsAre(1.0, 2.0, 3.0)) << id;
  }
  EXPECT_THAT(*decode("80 25 0C 00 10 00 00 00 20 00 00 FF F0 00 00").angular_rate, ElementsAre(1.0, 2.0, -1.0));
}

TEST(MtData2Test, QuaternionsAreScalarFirstAndEulerAnglesAreDegrees) {
  EXPECT_THAT(*decode("20 10 10 3F 00 00 00 3F 00 00 00 BF 00 00 00 3F 00 00 00").orientation,
              ElementsAre(0.5, 0.5, -0.5, 0.5));
  const auto q = *decode("20 30 0C 42 B4 00 00 00 00 00 00 00 00 00 00").orientation;  // 90 0 0
  EXPECT_NEAR(q[0], std::numbers::sqrt2 / 2, 1e-9);
  EXPECT_NEAR(q[1], std::numbers::sqrt2 / 2, 1e-9);
}

TEST(MtData2Test, UnknownItemsAreSkippedByTheirSize) {
  Counters counters;
  const MtData2 data = decode("70 10 04 00 00 00 01 12 34 00 FF F0 02 AA BB 10 20 02 00 07", &counters);
  EXPECT_EQ(data.packet_counter, 7);
  EXPECT_EQ(counters["skipped.items"], 3);
}

TEST(MtData2Test, ATruncatedItemIsCountedAndWhatCameBeforeItStands) {
  for (const char* tail : {"40", "40 20", "40 20 0C", "40 20 0C 3F 80 00 00 40 00 00 00 40 40 00"}) {
    Counters counters;
    const MtData2 data = decode(std::string("10 20 02 00 07 ") + tail, &counters);
    EXPECT_EQ(data.packet_counter, 7);
    EXPECT_FALSE(data.acceleration);
    EXPECT_TRUE(data.truncated);
    EXPECT_EQ(counters["refused.truncated"], 1) << tail;
  }
}

TEST(MtData2Test, NumbersThatCannotBeAreRefusedByCause) {
  Counters counters;
  EXPECT_FALSE(decode("40 20 0C 7F C0 00 00 00 00 00 00 00 00 00 00", &counters).acceleration);  // NaN
  EXPECT_EQ(counters["refused.not_finite"], 1);
  EXPECT_FALSE(decode("40 20 0C 7F 00 00 00 00 00 00 00 00 00 00 00", &counters).acceleration);  // 1.7e38
  EXPECT_FALSE(decode("20 10 10 3F 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00", &counters).orientation);
  EXPECT_EQ(counters["refused.range"], 2);
  EXPECT_FALSE(decode("40 20 04 3F 80 00 00", &counters).acceleration);
  EXPECT_FALSE(decode("10 20 04 00 00 00 01", &counters).packet_counter);
  EXPECT_EQ(counters["refused.item_size"], 2);
}

TEST(MtData2Test, RecordingsInEveryFormatAreDecodedToTheLastItem) {
  for (int i = 1; i <= 5; ++i) {
    const test::Bytes bytes = test::read_bytes(test::data_path("imu_xsens/") + std::to_string(i) + ".output.bin");
    if (bytes.empty()) GTEST_SKIP() << test::data_path("imu_xsens/") << i << ".output.bin is not there";
    Counters counters;
    int inertial = 0;
    int oriented = 0;
    std::optional<std::uint32_t> last;
    XbusParser parser;
    parser.parse(0, bytes, [&](const XbusFrame& frame) {
      const MtData2 data = decode_mtdata2(frame.data, counters);
      ASSERT_TRUE(data.sample_time_fine && data.packet_counter);
      oriented += data.orientation.has_value();
      if (!data.acceleration || !data.angular_rate) return;
      ++inertial;
      const std::uint32_t step = *data.sample_time_fine - last.value_or(*data.sample_time_fine - 100);
      EXPECT_TRUE(step == 100 || step == 200) << i;  // 100 Hz, now and then a GNSS message in between
      last = data.sample_time_fine;
      const auto& a = *data.acceleration;
      EXPECT_NEAR(std::hypot(a[0], a[1], a[2]), 9.8, 6.0) << i;
    });
    EXPECT_EQ(inertial, i < 5 ? 96 : 0) << i;  // the rest are GNSS messages; the fifth has free acceleration only
    EXPECT_GT(oriented, 90) << i;
    for (const char* cause : {"refused.truncated", "refused.item_size", "refused.not_finite", "refused.range"}) {
      EXPECT_EQ(counters[cause], 0) << cause << ", recording " << i;
    }
  }
}

TEST(MtData2Test, NoPayloadReadsBeyondItsEndOrGivesNumbersThatCannotBe) {
  std::mt19937 random(5);
  const test::Bytes ids = test::from_hex("08 10 10 20 10 60 20 10 20 30 40 20 80 20 E0 10 E0 20");
  for (int round = 0; round < 20'000; ++round) {
    test::Bytes payload;
    for (auto items = random() % 5; items > 0; --items) {
      const std::size_t k = random() % (ids.size() / 2);
      const test::Bytes data = test::random_bytes(random, random() % 34);
      test::append(payload, {ids[2 * k], static_cast<std::uint8_t>(ids[2 * k + 1] | random() % 4)});
      payload.push_back(static_cast<std::uint8_t>(random() % 8 == 0 ? random() : data.size()));
      test::append(payload, data);
    }
    const std::vector<std::uint8_t> exact(payload.begin(), payload.end());  // so that ASan sees its end
    Counters counters;
    const MtData2 data = decode_mtdata2(exact, counters);
    EXPECT_TRUE(!data.acceleration || std::isfinite((*data.acceleration)[0]));
    EXPECT_TRUE(!data.orientation || std::abs((*data.orientation)[0]) <= 1.0);
  }
}

}  // namespace
}  // namespace curbstone::imu::xsens
