#include "services/mapper/scan/lidar_clock.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/stamps.hpp"

namespace curbstone::mapper::scan {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using test::kSecond;
using test::kStart;

constexpr std::int64_t kInterval = 1'333;  // us, between packets
constexpr std::int64_t kEkf = 10'000;      // us, between odometry

/// LiDAR and odometry on a host: packets each kInterval, odometry each kEkf, heard 5 ms late. Both are stamped with the
/// true time plus what the test sets.
struct Host {
  /// Time goes on for `seconds`.
  void drive(double seconds) {
    for (const std::int64_t end = now + us(seconds); now < end;) send();
  }
  void send(std::int64_t damage = 0) {
    if (!is_odometry_silent) odometry = kStart + (now - 5'000) / kEkf * kEkf + odometry_off;
    lidar_points_t packet{};
    packet.utime = kStart + now + lidar_off + damage;
    packet.packet = number++;
    packet.revolution = static_cast<std::int32_t>(truth.size());  // which tells the test its true time
    truth.push_back(kStart + now);
    now += kInterval;
    clock.add(packet, odometry, handler);
  }
  /// What is sent for `seconds` is lost on the way.
  void lose(double seconds) {
    number += static_cast<std::int32_t>(us(seconds) / kInterval);
    now += us(seconds) / kInterval * kInterval;
  }
  void pause(double seconds) { now += us(seconds); }
  /// The largest error of a stamp, us.
  [[nodiscard]] std::int64_t worst() const {
    std::int64_t most = 0;
    for (const std::int64_t off : offs) most = std::max(most, std::abs(off));
    return most;
  }
  [[nodiscard]] bool is_all_out() const { return offs.size() == truth.size(); }
  [[nodiscard]] std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    clock.add_faults(faults);
    return faults;
  }
  static std::int64_t us(double seconds) { return std::llround(seconds * 1e6); }

  LidarClock clock;
  std::int64_t now = 0;           // us, true time since kStart
  std::int64_t lidar_off = 0;     // us
  std::int64_t odometry_off = 0;  // us
  bool is_odometry_silent = false;
  std::int64_t odometry = 0;  // us, newest
  std::int32_t number = 0;
  std::vector<std::int64_t> truth;  // us, of each packet sent
  std::vector<std::int64_t> offs;   // us, of each packet passed on: its stamp less its true time
  LidarClock::Handler handler = [this](const lidar_points_t& m) {
    offs.push_back(m.utime - truth.at(static_cast<std::size_t>(m.revolution)));
  };
};

TEST(LidarClock, AStepOfTheLidarsClockAloneIsTakenOut) {
  for (const std::int64_t by : {-2 * kSecond, -kSecond / 8, kSecond / 2, 2 * kSecond, 3600 * kSecond}) {
    SCOPED_TRACE(by);
    Host host;
    host.drive(3);
    host.lidar_off = by;
    host.drive(4);
    EXPECT_TRUE(host.is_all_out());
    EXPECT_LE(host.worst(), 2);
    EXPECT_EQ(host.clock.counters()["lidar.clock_corrections"], 1);
    EXPECT_THAT(host.faults(), ElementsAre(HasSubstr(by < 0 ? "s back, and" : "s ahead, and")));
  }
}

TEST(LidarClock, AStepWithLostPacketsIsTakenOut) {
  Host host;
  host.drive(3);
  host.lidar_off = -2 * kSecond;
  host.lose(0.3);
  host.drive(4);
  EXPECT_LE(host.worst(), 500) << "by the smoothed interval of the packets";
}

TEST(LidarClock, AClockThatIsSetRightAgainIsNotCorrectedAnyLonger) {
  Host host;
  host.drive(3);
  host.lidar_off = -2 * kSecond;
  host.drive(4);
  host.lidar_off = 0;
  host.drive(4);
  EXPECT_TRUE(host.is_all_out());
  EXPECT_EQ(host.offs.back(), 0);
  EXPECT_LE(host.worst(), 2);
  EXPECT_THAT(host.faults(), IsEmpty());
}

TEST(LidarClock, WhereAllClocksAreSetNothingIsCorrected) {
  for (const std::int64_t by : {-2 * kSecond, -kSecond / 8, kSecond / 2, 2 * kSecond, 3600 * kSecond}) {
    for (const double lidar_first : {-0.05, 0.0, 0.05, 0.15}) {
      SCOPED_TRACE(fmt::format("{} us, LiDAR {} s earlier", by, lidar_first));
      Host host;
      host.drive(3);
      (lidar_first < 0 ? host.odometry_off : host.lidar_off) = by;
      host.drive(std::abs(lidar_first));
      host.lidar_off = host.odometry_off = by;
      host.drive(4);
      EXPECT_TRUE(host.is_all_out());
      EXPECT_EQ(host.offs.back(), by);
      EXPECT_EQ(host.clock.counters()["lidar.clock_corrections"], 0);
      EXPECT_THAT(host.faults(), IsEmpty());
    }
  }
}

TEST(LidarClock, LateOdometryDoesNotMakeItTheLidarsClockAlone) {
  for (const std::int64_t by : {-2 * kSecond, kSecond / 2, 2 * kSecond}) {
    SCOPED_TRACE(by);
    Host host;
    host.drive(3);
    host.lidar_off = host.odometry_off = by;
    host.is_odometry_silent = true;
    host.drive(0.6);  // the ekf has no processor
    host.is_odometry_silent = false;
    host.drive(4);
    EXPECT_TRUE(host.is_all_out());
    EXPECT_EQ(host.offs.back(), by);
    EXPECT_EQ(host.clock.counters()["lidar.clock_corrections"], 0);
  }
}

/// NTP sets one host now, and the other a minute later.
TEST(LidarClock, WhereOdometrysClockFollowsTheCorrectionEnds) {
  Host host;
  host.drive(3);
  host.lidar_off = -2 * kSecond;
  host.drive(5);
  EXPECT_LE(std::abs(host.offs.back()), 2);
  host.odometry_off = -2 * kSecond;
  host.drive(3);
  EXPECT_TRUE(host.is_all_out());
  EXPECT_EQ(host.offs.back(), -2 * kSecond);
  EXPECT_THAT(host.faults(), IsEmpty());
}

TEST(LidarClock, APauseOfTheDriverIsNoStepAndHoldsNoMoreThanAPacket) {
  for (const double pause : {0.2, 0.6, 2.0, 30.0}) {
    SCOPED_TRACE(pause);
    Host host;
    host.drive(3);
    host.pause(pause);
    host.send();
    host.send();
    EXPECT_TRUE(host.is_all_out());
    host.drive(3);
    EXPECT_EQ(host.worst(), 0);
  }
}

TEST(LidarClock, ADriverThatSendsPartOfTheViewIsPassedOnWithItsNextPacketAtTheLatest) {
  Host host;
  for (int revolution = 0; revolution < 50; ++revolution) {
    host.pause(0.13);
    host.drive(0.07);
    EXPECT_TRUE(host.is_all_out());
  }
  EXPECT_EQ(host.worst(), 0);
}

TEST(LidarClock, ADriverThatStartsAgainWithTheClockSetBackIsCorrectedByOdometry) {
  Host host;
  host.drive(3);
  host.pause(1.5);
  host.number = 0;
  host.lidar_off = -5 * kSecond;
  host.drive(4);
  EXPECT_TRUE(host.is_all_out());
  EXPECT_LE(std::abs(host.offs.back()), kEkf + kInterval);
}

/// As after a power dip, or in a log of two drives.
TEST(LidarClock, AfterAPauseOfAllOdometryMayComeLaterThanADriverThatStartsAgain) {
  for (const double late : {0.0, 0.3, 0.8}) {
    SCOPED_TRACE(late);
    Host host;
    host.drive(3);
    host.pause(78);
    host.number = 0;
    host.is_odometry_silent = true;
    host.drive(late);
    host.is_odometry_silent = false;
    host.drive(3);
    EXPECT_TRUE(host.is_all_out());
    EXPECT_EQ(host.worst(), 0);
    EXPECT_EQ(host.clock.counters()["lidar.stamps_corrected"], 0);
    EXPECT_THAT(host.faults(), IsEmpty());
  }
}

TEST(LidarClock, APacketWhoseStampAloneIsDamagedIsMended) {
  Host host;
  host.drive(3);
  for (const std::int64_t damage : {-2 * kSecond, 3600 * kSecond, -kSecond / 5, -kSecond / 20, kSecond / 10}) {
    host.send(damage);
    host.drive(0.5);
  }
  EXPECT_TRUE(host.is_all_out());
  EXPECT_LE(host.worst(), 2);
  EXPECT_EQ(host.clock.counters()["lidar.stamps_corrected"], 5);
  EXPECT_THAT(host.faults(), IsEmpty());
}

TEST(LidarClock, RandomStampsHoldNothingForLong) {
  Host host;
  host.drive(3);
  for (int i = 0; i < 3000; ++i) {
    host.send((i * 7'919LL % 4'001 - 2'000) * 1'000);
  }
  host.drive(3);
  const std::int64_t refused = host.clock.counters()["refused.lidar_stamp"];
  EXPECT_EQ(static_cast<std::int64_t>(host.offs.size()) + refused, static_cast<std::int64_t>(host.truth.size()));
  EXPECT_EQ(host.offs.back(), 0);
}

TEST(LidarClock, StampsAndNumbersOfAnySizeAreSurvived) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  constexpr std::int32_t kLast = std::numeric_limits<std::int32_t>::max();
  LidarClock clock;
  std::mt19937 random(1);
  const std::int64_t stamps[] = {-kMost,    -1,        0,    1, kStart, kStart + 1'333, kStart - 5 * kSecond,
                                 kMost / 8, kMost / 2, kMost};
  const std::int32_t numbers[] = {-kLast - 1, -1, 0, 1, 2, 3, kLast - 1, kLast};
  std::size_t passed = 0;
  for (int i = 0; i < 100'000; ++i) {
    lidar_points_t packet{};
    packet.utime = stamps[random() % std::size(stamps)];
    packet.packet = numbers[random() % std::size(numbers)];
    clock.add(packet, std::max<std::int64_t>(stamps[random() % std::size(stamps)], 0), [&](const auto&) { ++passed; });
    (void)clock.corrected(packet.utime);
  }
  clock.release([&](const auto&) { ++passed; });
  EXPECT_EQ(passed + static_cast<std::size_t>(clock.counters()["refused.lidar_stamp"]), 100'000U);
}

TEST(LidarClock, StampsThatWereFarFromOdometrysFromTheBeginningAreNamed) {
  for (const std::int64_t off : {-2 * kSecond, 3600 * kSecond}) {
    Host host;
    host.lidar_off = off;
    host.drive(7);
    EXPECT_EQ(host.offs.back(), off);
    EXPECT_THAT(host.faults(),
                ElementsAre(HasSubstr(off < 0 ? "are 2.0 s behind odometry's" : "s ahead of odometry's")));
  }
}

TEST(LidarClock, OdometryThatIsSilentIsNoStampFarOff) {
  Host host;
  host.drive(3);
  host.is_odometry_silent = true;
  host.drive(10);
  EXPECT_THAT(host.faults(), IsEmpty());
}

TEST(LidarClock, WithoutOdometryNothingIsHeld) {
  Host host;
  host.is_odometry_silent = true;
  host.drive(3);
  host.lidar_off = -2 * kSecond;
  host.send();
  EXPECT_TRUE(host.is_all_out());
  EXPECT_EQ(host.offs.back(), -2 * kSecond);
}

TEST(LidarClock, OdometryThatEndsAtTheStepIsNotWaitedForForLong) {
  Host host;
  host.drive(3);
  host.is_odometry_silent = true;
  host.lidar_off = -2 * kSecond;
  host.drive(2.1);
  EXPECT_TRUE(host.is_all_out());
  EXPECT_EQ(host.offs.back(), -2 * kSecond);
}

TEST(LidarClock, AtTheEndOfTheDriveWhatIsHeldPassesAsItIs) {
  Host host;
  host.drive(3);
  host.lidar_off = -2 * kSecond;
  host.drive(0.1);
  EXPECT_FALSE(host.is_all_out());
  host.clock.release(host.handler);
  EXPECT_TRUE(host.is_all_out());
  EXPECT_EQ(host.offs.back(), -2 * kSecond);
}

}  // namespace
}  // namespace curbstone::mapper::scan
