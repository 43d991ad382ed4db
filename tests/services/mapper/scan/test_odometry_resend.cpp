#include "services/mapper/scan/odometry_resend.hpp"

#include <gtest/gtest.h>

#include "common/bus/local_bus.hpp"
#include "common/resend/message_keeper.hpp"
#include "services/mapper/scan/odometry_intake.hpp"
#include "tests/stamps.hpp"

namespace curbstone::mapper::scan {
namespace {

using test::kStart;
constexpr std::int64_t kOdometryPeriod = 10'000;  // us

odometry_t odometry_at(int i) {
  odometry_t message{};
  message.utime = kStart + kOdometryPeriod * i;
  message.flags = odometry_t::INITIALISED;
  message.orientation[0] = 1;
  message.position[0] = 0.03 * i + (i == 50 ? 0.02 : 0);
  return message;
}

Scan scan_at(int begin) {
  Scan scan;
  scan.start = kStart + kOdometryPeriod * begin;
  scan.end = scan.start + 50'000;
  return scan;
}

class OdometryResendTest : public ::testing::Test {
 protected:
  OdometryResendTest() {
    bus_.subscribe<resend_request_t>(kResendRequests, [this](const resend_request_t& m) {
      ++requests_;
      if (filter_answers_) keeper_.request(m);
    });
    bus_.subscribe<odometry_t>(resent_channel("ODOMETRY"), [this](const odometry_t& m) { resend_.add_resent(m); });
  }
  void send(int from, int to, bool are_heard = true) {
    for (int i = from; i < to; ++i) {
      keeper_.keep(odometry_at(i));
      if (are_heard) (void)take_odometry(odometry_at(i), history_, counters_);
    }
  }
  void tick() {
    now_ += 20'000;
    keeper_.tick();
    resend_.tick(now_);
    bus_.dispatch();
  }

  LocalBus bus_;
  MessageKeeper keeper_{bus_, "ODOMETRY"};
  OdometryHistory history_;
  OdometryResend resend_{bus_, "mapper", history_};
  bool filter_answers_ = true;
  int requests_ = 0;
  std::int64_t now_ = kStart;
  Counters counters_;
};

TEST_F(OdometryResendTest, NothingIsAskedForWhileNothingIsMissing) {
  send(0, 200);
  tick();
  EXPECT_FALSE(resend_.must_wait(scan_at(100)));
  EXPECT_EQ(requests_, 0);
}

TEST_F(OdometryResendTest, ASampleThatWasLostComesAgainAndTheScanWaitsForIt) {
  send(0, 50);
  send(50, 51, false);
  send(51, 100);
  EXPECT_TRUE(resend_.must_wait(scan_at(48)));
  tick();
  EXPECT_FALSE(resend_.must_wait(scan_at(48)));
  EXPECT_NEAR(history_.at(odometry_at(50).utime).translation().x(), 1.52, 1e-9);
}

TEST_F(OdometryResendTest, SecondsThatWereLostComeAgain) {
  send(0, 50);
  send(50, 420, false);
  send(420, 500);
  EXPECT_FALSE(resend_.must_wait(scan_at(30))) << "it needs none of it";
  EXPECT_TRUE(resend_.must_wait(scan_at(100)));
  for (int i = 0; i < 14; ++i) tick();
  EXPECT_FALSE(resend_.must_wait(scan_at(100)));
  EXPECT_TRUE(history_.covers(scan_at(300).start, scan_at(300).end));
  EXPECT_EQ(resend_.counters()["odometry.resent"], 370);
}

TEST_F(OdometryResendTest, AScanGoesOnWithoutWhatCannotBeHad) {
  filter_answers_ = false;
  send(0, 50);
  send(420, 500);
  EXPECT_TRUE(resend_.must_wait(scan_at(100)));
  for (int i = 0; i < 49; ++i) tick();
  EXPECT_TRUE(resend_.must_wait(scan_at(100)));
  for (int i = 0; i < 2; ++i) tick();
  EXPECT_FALSE(resend_.must_wait(scan_at(100)));
  EXPECT_FALSE(resend_.must_wait(scan_at(110))) << "once for a gap";
  EXPECT_EQ(resend_.counters()["odometry.not_resent"], 1);
}

TEST_F(OdometryResendTest, AStepThatIsShortIsNotWaitedForLong) {
  filter_answers_ = false;  // an IMU that leaves out a sample is no loss on the bus
  send(0, 50);
  send(51, 100);
  EXPECT_TRUE(resend_.must_wait(scan_at(48)));
  for (int i = 0; i < 16; ++i) tick();
  EXPECT_FALSE(resend_.must_wait(scan_at(48)));
}

TEST_F(OdometryResendTest, ASuccessorAsksForWhatWasSentBeforeItsTime) {
  send(0, 300, false);
  history_.begin_at(kStart + 100 * kOdometryPeriod);
  send(300, 310);
  EXPECT_TRUE(resend_.must_wait(scan_at(110)));
  for (int i = 0; i < 8; ++i) tick();
  EXPECT_FALSE(resend_.must_wait(scan_at(110)));
  EXPECT_TRUE(history_.covers(scan_at(101).start, scan_at(250).end));
}

}  // namespace
}  // namespace curbstone::mapper::scan
