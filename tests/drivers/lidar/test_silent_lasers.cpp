#include "drivers/lidar/silent_lasers.hpp"

#include <gmock/gmock.h>

#include <filesystem>

#include "tests/drivers/lidar/bench.hpp"
#include "tests/paths.hpp"
#include "tests/stamps.hpp"

namespace curbstone::lidar {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using test::kStart;
constexpr int kLasers = 16;

class SilentLasersTest : public ::testing::Test {
 protected:
  /// `seconds` in which the lasers that `returns` tells return, ten times a second.
  template <class Returns>
  void pass(int seconds, Returns returns) {
    std::vector<std::uint8_t> rings;
    for (int ring = 0; ring < kLasers; ++ring) {
      if (returns(ring)) rings.insert(rings.end(), 30, static_cast<std::uint8_t>(ring));
    }
    for (int i = 0; i < 10 * seconds; ++i, now_ += 100'000) lasers_.add(now_, rings);
  }
  static bool all(int /*ring*/) { return true; }

  SilentLasers lasers_;
  std::int64_t now_ = kStart;
};

TEST_F(SilentLasersTest, ALaserThatStopsBetweenOthersIsNamedUntilItReturns) {
  pass(12, all);
  pass(4, [](int ring) { return ring != 7; });
  EXPECT_THAT(lasers_.silent(), IsEmpty()) << "not yet";
  pass(3, [](int ring) { return ring != 7; });
  EXPECT_THAT(lasers_.silent(), ElementsAre(7));
  pass(3, [](int) { return false; });
  EXPECT_THAT(lasers_.silent(), ElementsAre(7)) << "nor do the others return: that tells nothing new";
  pass(2, all);
  EXPECT_THAT(lasers_.silent(), IsEmpty());
}

TEST_F(SilentLasersTest, TwoNeighboursAndTheLowestAreNamed) {
  pass(12, all);
  pass(7, [](int ring) { return ring != 0 && ring != 8 && ring != 9; });
  EXPECT_THAT(lasers_.silent(), ElementsAre(0, 8, 9));
}

TEST_F(SilentLasersTest, TheSkyIsNoFault) {
  pass(12, all);
  pass(60, [](int ring) { return ring < 9; });  // out of the hall
  EXPECT_THAT(lasers_.silent(), IsEmpty());
  pass(60, [](int ring) { return ring < 9 || ring == 14; });  // a thing high above, that not all had seen
  EXPECT_THAT(lasers_.silent(), IsEmpty()) << "what did not return before is not missed";
}

TEST_F(SilentLasersTest, OneThatWasNeverHeardIsNotMissed) {
  pass(60, [](int ring) { return ring != 3; });
  EXPECT_THAT(lasers_.silent(), IsEmpty());
}

TEST_F(SilentLasersTest, ALeapOfTimeIsNoSilence) {
  pass(12, all);
  for (int i = 0; i < 20; ++i) {
    now_ += (i % 2 == 0 ? 3'600 : -7'000) * std::int64_t{1'000'000};
    pass(1, [](int ring) { return ring != 7; });
  }
  EXPECT_THAT(lasers_.silent(), IsEmpty());
}

/// The recording, again and again.
TEST(SilentLasers, NoLaserOfARealDeviceIsSilent) {
  const std::string file = test::data_path("rs16/rs16_washing_house.pcap");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  Bench bench;
  for (const RecordedPacket& packet : recording(file)) bench.send(packet.bytes, packet.received, packet.port);
  bench.finish();
  ASSERT_FALSE(bench.points.empty());
  SilentLasers lasers;
  const std::int64_t span = bench.points.back().utime - bench.points.front().utime + 1332;
  for (std::int64_t turn = 0; turn * span < 60'000'000; ++turn) {
    for (const lidar_points_t& m : bench.points) {
      lasers.add(m.utime + turn * span, m.ring);
      ASSERT_THAT(lasers.silent(), IsEmpty());
    }
  }
}

}  // namespace
}  // namespace curbstone::lidar
