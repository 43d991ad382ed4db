// Counters of few bits: beyond half of their range the shortest way is not the one that the wheel has gone.
#include <gmock/gmock.h>

#include <cmath>
#include <curbstone/wheels_t.hpp>
#include <optional>

#include "drivers/encoder/encoder_node.hpp"
#include "tests/drivers/recorder.hpp"

namespace curbstone::encoder {
namespace {

using ::testing::HasSubstr;

/// A node that sends counters of 16 bits every 10 ms, of wheels with 16384 counts a turn.
class NarrowCounters : public ::testing::Test {
 protected:
  NarrowCounters() {
    EncoderConfig config;
    config.signals.kind = SignalKind::kCounts;
    config.signals.left = "100 0|16@1+";
    config.signals.right = "100 16|16@1+";
    config.invert_right = false;
    config.counts_per_revolution = 16384;
    node_.emplace(config, recorder_.bus());
  }
  /// `seconds` at a speed that begins with the present one and changes by `acceleration`, rad/s^2.
  void drive(double seconds, bool heard = true, double acceleration = 0) {
    for (const std::int64_t end = now_ + std::llround(seconds * 1e6); now_ < end; now_ += 10'000) {
      speed_ += 0.01 * acceleration;
      angle_ += 0.01 * speed_;
      const auto count = static_cast<std::int64_t>(std::floor(angle_ * 16384 / (2 * M_PI)));
      const auto low = static_cast<std::uint8_t>(count), high = static_cast<std::uint8_t>(count >> 8);
      if (heard) node_->on_frame(now_ + 200, can::CanFrame::make(0x100, {low, high, low, high}));
      node_->tick(now_ + 300);
    }
  }
  [[nodiscard]] std::int64_t count(const char* name) const { return node_->report().counters[name]; }

  test::Recorder<wheels_t> recorder_{"WHEELS"};
  std::optional<EncoderNode> node_;
  std::int64_t now_ = 1'700'000'000'000'000;
  double speed_ = 0;  // rad/s
  double angle_ = 0;
};

TEST_F(NarrowCounters, AGapInWhichTheyMayHaveWrappedMakesNoWrongSpeed) {
  drive(1);
  drive(3, true, 10);
  for (const double gap : {0.05, 0.2, 0.3, 0.4, 0.45, 0.48}) {  // at 30 rad/s half the range is 0.42 s
    const std::size_t before = recorder_.messages().size();
    drive(gap, false);
    drive(2);
    ASSERT_GT(recorder_.messages().size(), before + 100) << gap;
    for (std::size_t i = before; i < recorder_.messages().size(); ++i) {
      const double speed = recorder_.messages()[i].speed[0];
      ASSERT_TRUE(std::abs(speed - 30) < 2 || speed == 0) << speed << " after " << gap << " s";
      ASSERT_GE(recorder_.messages()[i].angle[0], recorder_.messages()[i - 1].angle[0]) << gap;
    }
  }
  EXPECT_GE(count("counts_restarted"), 2) << "the distance is not known";
  EXPECT_LE(count("counts_restarted"), 4) << "that of the short gaps is";
}

TEST_F(NarrowCounters, AGapAtWalkingPaceCostsNothing) {
  drive(1);
  drive(1, true, 3);
  drive(0.45, false);
  drive(1);
  node_->finish();
  EXPECT_EQ(count("counts_restarted"), 0);
  EXPECT_NEAR(recorder_.messages().back().angle[0], angle_, 0.1);
}

/// At the highest speed that is configured it goes half around between two frames.
TEST(NarrowCounterConfig, ACounterThatIsTooNarrowForItsWheelIsRefused) {
  test::Recorder<wheels_t> recorder("WHEELS");
  EncoderConfig config;
  config.signals.kind = SignalKind::kCounts;
  config.signals.left = "100 0|10@1+";
  config.signals.right = "100 16|16@1+";
  try {
    const EncoderNode node(config, recorder.bus());
    FAIL() << "150 rad/s are 978 counts in 10 ms";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("encoder.signals.left: \"100 0|10@1+\": a wheel at max_speed"));
  }
  config.max_speed = 50;
  EXPECT_NO_THROW(EncoderNode(config, recorder.bus()));
}

}  // namespace
}  // namespace curbstone::encoder
