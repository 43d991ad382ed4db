// Faults of a WitMotion that last for the rest of a drive: what is wrong is withheld, named, and used again once it is
// right.
#include <gmock/gmock.h>

#include <cmath>
#include <curbstone/imu_t.hpp>
#include <random>

#include "drivers/imu/imu_node.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/wit_emulator.hpp"

namespace curbstone::imu {
namespace {

using simulate::devices::XsensSample;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using test::kStart;

/// On a vehicle that drives, over the wire, in the device's own steps.
class WitLastingFaults : public ::testing::Test {
 protected:
  WitLastingFaults()
      : node_(witmotion(), recorder_.bus(), [this](auto bytes) {
          if (obeys_) device_.on_bytes(bytes);
        }) {
    device_.power_on(now_);
    drive(6);
  }
  static ImuConfig witmotion() {
    ImuConfig config;
    config.model = Model::kWitMotion;
    return config;
  }
  void drive(double seconds, const std::function<void(XsensSample&)>& spoil = {},
             const std::function<void(test::Bytes&)>& garble = {}) {
    for (const std::int64_t end = now_ + std::llround(seconds * 1e6); now_ < end;) {
      now_ += device_.period();
      const double t = static_cast<double>(now_ - kStart) * 1e-6;
      XsensSample sample;
      sample.acceleration = {2 * std::sin(t) + noise(0.3), noise(0.3), 9.81 + noise(0.5)};
      sample.angular_rate = {noise(0.01), noise(0.01), 0.4 * std::sin(0.7 * t) + noise(0.01)};
      sample.orientation = {{1, 0, 0, 0}};
      if (spoil) spoil(sample);
      test::Bytes bytes = device_.sample(now_, sample);
      if (garble) garble(bytes);
      node_.on_bytes(now_ + 500, bytes);
      node_.tick(now_ + 600);
    }
  }
  double noise(double sigma) { return std::normal_distribution<>(0, sigma)(random_); }
  std::size_t published() { return recorder_.messages().size(); }
  std::int64_t count(const char* name) const { return node_.report().counters[name]; }
  std::vector<std::string> faults() const { return node_.report().faults; }
  /// Good samples are published again, all of them.
  void expect_recovery() {
    drive(5);
    const std::size_t before = published();
    drive(5);
    EXPECT_NEAR(static_cast<double>(published() - before), 500, 2);
    EXPECT_THAT(faults(), IsEmpty());
  }

  test::Recorder<imu_t> recorder_{"IMU"};
  simulate::devices::WitEmulator device_;
  bool obeys_ = true;  // it takes commands
  ImuNode node_;
  std::int64_t now_ = kStart;
  std::mt19937 random_{1};
};

TEST_F(WitLastingFaults, FrozenRegistersAreWithheldAndNamed) {
  const auto frozen = [](XsensSample& s) {
    s.acceleration = {0.1, -0.2, 9.8};
    s.angular_rate = {0.01, 0.02, 0.3};
  };
  drive(2.2, frozen);
  const std::size_t before = published();
  drive(60, frozen);
  EXPECT_EQ(published(), before);
  EXPECT_GE(count("withheld.stuck_accelerometer"), 5900);
  EXPECT_THAT(faults(), Contains(HasSubstr("accelerometer is stuck")));
  expect_recovery();
}

TEST_F(WitLastingFaults, AGyroThatIsDeadIsWithheldAndNamed) {
  const auto dead = [](XsensSample& s) { s.angular_rate = {0, 0, 0}; };
  drive(4.2, dead);
  const std::size_t before = published();
  drive(60, dead);
  EXPECT_EQ(published(), before);
  EXPECT_THAT(faults(), Contains(HasSubstr("gyro is stuck")));
  expect_recovery();
}

/// The same bytes, its time too: a bridge or a program that repeats what it had.
TEST_F(WitLastingFaults, OneSampleWithItsTimeOverAndOverIsRefused) {
  test::Bytes last;
  const auto repeat = [&](test::Bytes& bytes) { last.empty() ? void(last = bytes) : void(bytes = last); };
  drive(0.1, {}, repeat);
  const std::size_t before = published();
  drive(60, {}, repeat);
  EXPECT_EQ(published(), before);
  EXPECT_GE(count("refused.repeated"), 5900);
  EXPECT_THAT(faults(), Contains(HasSubstr("no sample from the IMU")));
  EXPECT_THAT(faults(), Contains(HasSubstr("refused.repeated")));
  expect_recovery();
}

TEST_F(WitLastingFaults, AForceAtTheEndOfItsRangeIsFlaggedAtOnceAndWithheldIfItStays) {
  const auto spoil = [](XsensSample& s) { s.acceleration[0] = 50 * 9.81; };
  const std::size_t before = published();
  drive(4.2, spoil);
  for (std::size_t i = before; i < published(); ++i) EXPECT_NE(recorder_.messages()[i].status & imu_t::CLIPPING, 0);
  const std::size_t withheld = published();
  drive(30, spoil);
  EXPECT_EQ(published(), withheld);
  EXPECT_GE(count("withheld.stuck_accelerometer"), 2900);
  EXPECT_THAT(faults(), Contains(HasSubstr("accelerometer is stuck")));
  EXPECT_THAT(faults(), Contains(HasSubstr("clips")));
  expect_recovery();
}

TEST_F(WitLastingFaults, ARateAtTheEndOfItsRangeIsFlaggedAtOnceAndItsAxisNamedIfItStays) {
  const auto spoil = [](XsensSample& s) { s.angular_rate[2] = 40; };  // 2292 deg/s
  const std::size_t before = published();
  drive(0.4, spoil);
  for (std::size_t i = before; i < published(); ++i) EXPECT_EQ(recorder_.messages()[i].status, imu_t::CLIPPING);
  drive(0.2, spoil);
  const std::size_t named = published();
  drive(30, spoil);
  EXPECT_NEAR(static_cast<double>(published() - named), 3000, 2);
  for (std::size_t i = named; i < published(); ++i) EXPECT_EQ(recorder_.messages()[i].status, imu_t::GYRO_Z_STUCK);
  EXPECT_GE(count("stuck.gyro_z"), 2990);
  EXPECT_THAT(faults(), ElementsAre(HasSubstr("the end of its range about z")));
  expect_recovery();
}

TEST_F(WitLastingFaults, MinutesOfAWrongBaudPublishNothingAndAreReported) {
  const std::size_t before = published();
  drive(180, {}, [&](test::Bytes& bytes) { bytes = test::random_bytes(random_, bytes.size() + random_() % 20); });
  EXPECT_LE(published(), before + 1);  // a checksum is a byte
  EXPECT_THAT(faults(), Contains(HasSubstr("garbage from the IMU: wrong baud")));
  expect_recovery();
}

TEST_F(WitLastingFaults, ARateThatSomebodyElseSetsIsReportedAndSetRight) {
  for (const std::uint8_t rate : {std::uint8_t{8}, std::uint8_t{11}, std::uint8_t{7}}) {  // 50, 200, 20 Hz
    device_.on_bytes(std::vector<std::uint8_t>{0xFF, 0xAA, 0x69, 0x88, 0xB5, 0xFF, 0xAA, 0x03, rate, 0x00});
    const std::int64_t period = device_.period();
    ASSERT_NE(period, 10'000);
    drive(1.5);
    const std::size_t before = published();
    drive(1);
    EXPECT_NEAR(static_cast<double>(published() - before), 1e6 / static_cast<double>(period), 2);
    for (std::size_t i = before + 1; i < published(); ++i)
      EXPECT_NEAR(static_cast<double>(recorder_.messages()[i].utime - recorder_.messages()[i - 1].utime),
                  static_cast<double>(period), 200);
    const std::int64_t set_up = count("device.reconfigured");
    bool reported = false;
    for (int i = 0; i < 80 && !reported; ++i) {
      drive(0.05);
      reported = ::testing::Matches(Contains(HasSubstr("Hz, 100 Hz was asked for")))(faults());
    }
    EXPECT_TRUE(reported);
    EXPECT_EQ(count("device.reconfigured"), set_up + 1);
    expect_recovery();
  }
}

TEST_F(WitLastingFaults, ARateThatCannotBeSetStaysAFaultAndItsSamplesAreUsed) {
  device_.on_bytes(std::vector<std::uint8_t>{0xFF, 0xAA, 0x69, 0x88, 0xB5, 0xFF, 0xAA, 0x03, 0x08, 0x00});
  obeys_ = false;
  drive(10);
  for (int i = 0; i < 20; ++i) {
    const std::size_t before = published();
    drive(3);
    EXPECT_EQ(published() - before, 150U);
    EXPECT_THAT(faults(), Contains(HasSubstr("the IMU sends at 50 Hz, 100 Hz was asked for")));
  }
  obeys_ = true;
  expect_recovery();
}

TEST_F(WitLastingFaults, AUnitThatRestartsEachThreeSecondsIsReportedAndNoStampIsWrong) {
  std::size_t checked = published();
  for (int restart = 0; restart < 15; ++restart) {
    device_.power_on(now_);
    drive(3);
  }
  EXPECT_THAT(faults(), Contains(HasSubstr("the IMU has restarted 3 times within a minute")));
  EXPECT_GT(published(), checked + 15 * 150);
  for (std::int64_t last = 0; checked < published(); ++checked) {
    const std::int64_t utime = recorder_.messages()[checked].utime;
    EXPECT_GT(utime, last);
    EXPECT_LE(std::abs((utime - 500 - kStart + 5'000) % 10'000 - 5'000), 1'100) << "us, at " << checked;
    last = utime;
  }
  drive(65);
  EXPECT_THAT(faults(), IsEmpty());
}

}  // namespace
}  // namespace curbstone::imu
