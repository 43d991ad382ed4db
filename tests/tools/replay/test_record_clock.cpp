#include "tools/replay/record_clock.hpp"

#include <gtest/gtest.h>

#include <curbstone/tile_index_t.hpp>

namespace curbstone::replay {
namespace {

constexpr std::int64_t kSecond = 1'000'000;

LineItem message(std::int64_t utime, std::int64_t now) {
  tile_index_t m{};
  m.utime = utime;
  LineItem item;
  item.bytes.resize(static_cast<std::size_t>(m.getEncodedSize()));
  m.encode(item.bytes.data(), 0, m.getEncodedSize());
  item.now = now;
  return item;
}

TEST(RecordClock, AMeasurementHasItsOwnTime) {
  RecordClock clock;
  EXPECT_EQ(clock.time_of(message(100 * kSecond, 0)), 100 * kSecond) << "before the first beat";
  EXPECT_EQ(clock.time_of(message(100 * kSecond + 50, 0)), 100 * kSecond + 50);
  EXPECT_EQ(clock.time_of(message(100 * kSecond + 900, 100 * kSecond + 500)), 100 * kSecond + 900);
}

TEST(RecordClock, ATileOfOldPointsHasTheTimeOfTheMessageBeforeIt) {
  RecordClock clock;
  EXPECT_EQ(clock.time_of(message(100 * kSecond, 0)), 100 * kSecond);
  EXPECT_EQ(clock.time_of(message(60 * kSecond, 0)), 100 * kSecond);
  EXPECT_EQ(clock.time_of(message(60 * kSecond, 101 * kSecond)), 101 * kSecond) << "time has gone on";
}

TEST(RecordClock, ADamagedStampDoesNotCarryItAway) {
  RecordClock clock;
  EXPECT_EQ(clock.time_of(message(100 * kSecond, 100 * kSecond)), 100 * kSecond);
  EXPECT_EQ(clock.time_of(message(5000 * kSecond, 100 * kSecond)), 100 * kSecond);
  EXPECT_EQ(clock.time_of(message(100 * kSecond + 50, 100 * kSecond)), 100 * kSecond + 50);
  EXPECT_EQ(clock.time_of({}), 100 * kSecond + 50) << "too short for a stamp";
}

TEST(RecordClock, WhereTheReplaysTimeIsSetBackItFollows) {
  RecordClock clock;
  EXPECT_EQ(clock.time_of(message(100 * kSecond, 100 * kSecond)), 100 * kSecond);
  EXPECT_EQ(clock.time_of(message(40 * kSecond + 7, 40 * kSecond)), 40 * kSecond + 7);
}

}  // namespace
}  // namespace curbstone::replay
