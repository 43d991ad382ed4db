#include "services/mapper/scan/scan_synchronizer.hpp"

#include <gtest/gtest.h>

#include "common/bus/local_bus.hpp"
#include "tests/stamps.hpp"

namespace curbstone::mapper::scan {
namespace {

using test::kStart;
constexpr std::int64_t kPacketPeriod = 5'000;  // us; ten packets are a revolution

class ScanSynchronizerTest : public ::testing::Test {
 protected:
  void send_packets(int from, int to) {
    for (int i = from; i < to; ++i) {
      lidar_points_t m{};
      m.utime = kStart + kPacketPeriod * i + lidar_off_;
      m.packet = i;
      m.revolution = i / 10;
      m.num_points = 1;
      m.x = {5.0F};
      m.y = m.z = m.time_offset = {0.0F};
      m.intensity = m.ring = {1};
      input_.add(m);
    }
  }
  bool send_odometry(int ms, std::int32_t flags = odometry_t::INITIALISED) {
    odometry_t m{};
    m.utime = kStart + 1000 * static_cast<std::int64_t>(ms);
    m.flags = flags;
    m.orientation[0] = 1;
    return input_.add(m);
  }
  [[nodiscard]] std::int64_t counter(const char* name) const {
    Counters counters;
    input_.add_counters(counters);
    return counters[name];
  }

  std::int64_t lidar_off_ = 0;  // us
  LocalBus bus_;
  ScanSynchronizer input_{bus_, "mapper", {2.0, 1.0}};
};

TEST_F(ScanSynchronizerTest, AScanIsDueOnceOdometryHasReachedItsEnd) {
  EXPECT_TRUE(send_odometry(-10));
  send_packets(0, 11);
  ASSERT_FALSE(input_.empty());
  EXPECT_FALSE(input_.has_odometry());
  EXPECT_FALSE(input_.is_due(true));
  for (int ms = 0; ms <= 50; ms += 10) send_odometry(ms);
  EXPECT_TRUE(input_.is_due(true));
  const Scan scan = input_.pop();
  EXPECT_EQ(scan.start, kStart);
  EXPECT_TRUE(input_.odometry().covers(scan.start, scan.end));
  EXPECT_TRUE(input_.empty());
  EXPECT_EQ(input_.first_start(), kStart);
}

TEST_F(ScanSynchronizerTest, WhereTheLidarsClockAloneIsSetBackItsScansGoOnAndHaveOdometry) {
  std::int64_t last_end = 0;
  for (int packet = 0, ms = 0; ms < 6000; ms += 5, ++packet) {
    if (ms % 10 == 0) send_odometry(ms);
    if (ms == 3000) lidar_off_ = -2'000'000;
    send_packets(packet, packet + 1);
    while (!input_.empty() && input_.is_due(true)) {
      const Scan scan = input_.pop();
      EXPECT_TRUE(input_.odometry().covers(scan.start, scan.end));
      EXPECT_TRUE(last_end == 0 || scan.start == last_end + kPacketPeriod) << ms;
      last_end = scan.end;
    }
  }
  EXPECT_GT(last_end, kStart + 5'800'000);
  EXPECT_EQ(counter("lidar.clock_corrections"), 1);
}

TEST_F(ScanSynchronizerTest, WithoutOdometryTheFirstScanWaitsLongestAndTheOnesAfterAWaitWithoutResultLeast) {
  int sent = 0;
  const auto wait = [&](bool started) {
    for (; input_.empty() || !input_.is_due(started); ++sent) send_packets(sent, sent + 1);
    const std::int64_t end = input_.pop().end;
    input_.note_processed(end, false);
    return static_cast<double>(kStart + kPacketPeriod * (sent - 1) - end) * 1e-6;
  };
  EXPECT_NEAR(wait(false), 2.0, 0.06);
  while (!input_.empty()) (void)input_.pop();
  EXPECT_NEAR(wait(true), 0.25, 0.06);
}

TEST_F(ScanSynchronizerTest, OdometryThatComesAfterItsScanIsAFault) {
  send_packets(0, 11);
  const Scan scan = input_.pop();
  input_.note_processed(scan.end, false);
  for (int ms = 0; ms <= 50; ms += 10) send_odometry(ms);
  EXPECT_EQ(counter("odometry.too_late"), 1);
  std::vector<std::string> faults;
  input_.add_odometry_faults(faults, true, scan.end);
  EXPECT_EQ(faults.size(), 1U);
}

TEST_F(ScanSynchronizerTest, AFilterThatIsNotInitialisedMayStillStartInTime) {
  send_packets(0, 11);
  for (int ms = -10; ms <= 50; ms += 10) send_odometry(ms, 0);
  ASSERT_TRUE(input_.is_due(false));
  EXPECT_TRUE(input_.is_filter_starting(input_.pop()));
  for (int ms = 60; ms <= 3000; ms += 10) send_odometry(ms, 0);
  send_packets(11, 601);
  Scan last = input_.pop();
  while (!input_.empty()) last = input_.pop();
  EXPECT_FALSE(input_.is_filter_starting(last)) << "after the wait";
}

TEST_F(ScanSynchronizerTest, TooManyScansDropTheOldest) {
  send_packets(0, 10 * (static_cast<int>(ScanSynchronizer::kMaxPending) + 3) + 1);
  EXPECT_EQ(counter("dropped.pending"), 3);
  EXPECT_EQ(input_.pop().number, 3);
}

TEST_F(ScanSynchronizerTest, AtTheEndOfTheDriveTheLastScanComesToo) {
  send_packets(0, 5);
  EXPECT_TRUE(input_.empty());
  input_.flush();
  ASSERT_FALSE(input_.empty());
  EXPECT_EQ(input_.pop().packets, 5);
}

}  // namespace
}  // namespace curbstone::mapper::scan
