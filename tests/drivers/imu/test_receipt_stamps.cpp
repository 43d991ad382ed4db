#include "drivers/imu/receipt_stamps.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <vector>

#include "drivers/imu/imu_node.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/stamps.hpp"

namespace curbstone::imu {
namespace {

using test::kStart;

TEST(ReceiptStamps, ASampleByItselfKeepsItsTimeOfReceipt) {
  ReceiptStamps stamps(100);
  std::int64_t published = 0;
  for (std::int64_t now = kStart; now < kStart + 5'000'000; now += 10'000 + now % 7 * 100) {
    std::vector<std::int64_t> times = {now};
    stamps.spread(now, published, times);
    EXPECT_EQ(times[0], now);
    published = now;
  }
}

TEST(ReceiptStamps, SamplesOfOneReadLieAPeriodApart) {
  ReceiptStamps stamps(100);
  std::vector<std::int64_t> times = {kStart, kStart, kStart};
  stamps.spread(kStart, 0, times);
  EXPECT_EQ(times, (std::vector<std::int64_t>{kStart - 20'000, kStart - 10'000, kStart}));
}

TEST(ReceiptStamps, ThePeriodIsWhatTheDeviceSendsWith) {
  ReceiptStamps stamps(100);
  std::int64_t published = 0;
  for (int read = 0; read < 100; ++read) {  // 50 Hz, two a read
    const std::int64_t now = kStart + 40'000 * read;
    std::vector<std::int64_t> times = {now, now};
    stamps.spread(now, published, times);
    published = now;
    if (read > 60) {
      EXPECT_EQ(times[0], now - 20'000);
    }
  }
  EXPECT_EQ(stamps.period(), 20'000);
}

TEST(ReceiptStamps, WhereThePeriodWouldGoBehindWhatWentOutTheyLieEvenly) {
  ReceiptStamps stamps(100);
  std::vector<std::int64_t> times(4, kStart + 20'000);
  stamps.spread(kStart + 20'000, kStart, times);
  EXPECT_EQ(times, (std::vector<std::int64_t>{kStart + 5'000, kStart + 10'000, kStart + 15'000, kStart + 20'000}));
}

TEST(ReceiptStamps, ASampleThatBeganInTheReadBeforeComesAfterItsSamples) {
  ReceiptStamps stamps(100);
  std::vector<std::int64_t> times = {kStart};
  stamps.spread(kStart + 16'000, kStart, times);
  EXPECT_EQ(times[0], kStart + 10'000);
}

TEST(ReceiptStamps, AClockThatWasSetBackLeavesThemAsTheyAre) {
  ReceiptStamps stamps(100);
  std::vector<std::int64_t> times = {kStart, kStart};
  stamps.spread(kStart, kStart + 1'000'000, times);
  EXPECT_EQ(times, (std::vector<std::int64_t>{kStart, kStart}));
}

/// A WitMotion as it is bought, but at 100 Hz: it sends no time.
class UntimedImu : public ::testing::TestWithParam<std::int64_t> {};

TEST_P(UntimedImu, LosesNoSampleHoweverManyAReadBrings) {
  test::Recorder<imu_t> recorder{"IMU"};
  ImuConfig config;
  config.model = Model::kWitMotion;
  config.configure = false;
  ImuNode node(config, recorder.bus());
  const test::Bytes acceleration = test::from_hex("55 51 00 00 00 00 00 08 CA 09 81");
  const test::Bytes other = test::from_hex("55 51 01 00 01 00 01 08 CA 09 84");  // no sensor is still
  const test::Bytes rate = test::from_hex("55 52 00 00 00 00 00 00 CA 09 7A");
  const test::Bytes other_rate = test::from_hex("55 52 01 00 01 00 01 00 CA 09 7D");
  std::mt19937 random(1);
  test::Bytes waiting;
  std::int64_t read = kStart;
  constexpr int kSamples = 2000;
  for (int i = 0; i < kSamples; ++i) {
    const std::int64_t taken = kStart + 10'000 * i;
    for (; read <= taken; read += GetParam() + static_cast<std::int64_t>(random() % 3000)) {
      if (!waiting.empty()) node.on_bytes(read, waiting);
      waiting.clear();
    }
    test::append(waiting, i % 2 == 0 ? acceleration : other);
    test::append(waiting, i % 2 == 0 ? rate : other_rate);
  }
  node.on_bytes(kStart + 10'000 * kSamples, waiting);
  NodeReport report = node.report();
  EXPECT_EQ(report.counters["dropped.not_newer"], 0);
  ASSERT_GE(recorder.messages().size(), kSamples - 2U);  // the last one has not ended yet
  std::int64_t worst = 0;
  for (std::size_t i = 1; i < recorder.messages().size(); ++i) {
    const imu_t& m = recorder.messages()[i];
    EXPECT_GT(m.utime, recorder.messages()[i - 1].utime);
    const std::int64_t late = m.utime - (kStart + 10'000 * m.sequence);
    if (i > 500) worst = std::max(worst, std::abs(late));
  }
  std::printf("[ figure ] a read each %.0f ms: stamps at most %.1f ms off\n", 1e-3 * static_cast<double>(GetParam()),
              1e-3 * static_cast<double>(worst));
  EXPECT_LT(worst, 12'000);  // a sample may have waited for a period when it is read
}
INSTANTIATE_TEST_SUITE_P(Read, UntimedImu, ::testing::Values(1'000, 16'000, 50'000, 200'000));

}  // namespace
}  // namespace curbstone::imu
