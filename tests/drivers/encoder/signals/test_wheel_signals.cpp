#include "drivers/encoder/signals/wheel_signals.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "drivers/encoder/encoder_node.hpp"
#include "tests/drivers/recorder.hpp"

namespace curbstone::encoder::signals {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

can::CanFrame word(std::uint32_t id, int value) {
  return can::CanFrame::make(id, {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8)});
}

TEST(WheelSignalsTest, ACounterOfAnyWidthIsUnwrappedTheShortestWay) {
  WheelSignals wheels(CanSignal::parse("100 0|8@1+"), CanSignal::parse("100 8|8@1+"));
  const auto counts = [&](int left, int right) { return wheels.on_frame(word(0x100, left | right << 8))->counts; };
  const auto first = counts(250, 5);
  const auto second = counts(4, 250);
  EXPECT_EQ(second[0] - first[0], 10);
  EXPECT_EQ(second[1] - first[1], -11);
}

TEST(WheelSignalsTest, WheelsInTwoFramesMakeAPairWhenBothHaveCome) {
  WheelSignals wheels(CanSignal::parse("100 0|16@1-"), CanSignal::parse("101 0|16@1-"));
  EXPECT_FALSE(wheels.on_frame(word(0x100, 1)));
  ASSERT_TRUE(wheels.on_frame(word(0x101, 2)));
  EXPECT_FALSE(wheels.on_frame(word(0x101, 3)));
  EXPECT_FALSE(wheels.on_frame(word(0x101, 4)));
  const auto pair = wheels.on_frame(word(0x100, 5));
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->counts, (std::array<std::int32_t, 2>{5, 4}));
  EXPECT_EQ(wheels.counters()["lost.halves"], 1);
  EXPECT_FALSE(wheels.on_frame(word(0x102, 1)));
  EXPECT_EQ(wheels.counters()["ignored.frames"], 1);
  EXPECT_FALSE(wheels.on_frame(can::CanFrame::make(0x100, {1})));
  EXPECT_EQ(wheels.counters()["refused.length"], 1);
}

/// The node on raw frames, every 10 ms.
class SignalNode : public ::testing::Test {
 protected:
  static EncoderConfig config(SignalKind kind) {
    EncoderConfig config;
    config.signals.kind = kind;
    config.signals.left = kind == SignalKind::kCounts ? "100 0|16@1+" : "100 0|16@1- (0.001,0)";
    config.signals.right = kind == SignalKind::kCounts ? "100 16|16@1+" : "100 16|16@1- (0.001,0)";
    return config;
  }
  void make(SignalKind kind) {
    node_.emplace(config(kind), recorder_.bus(), [this](const can::CanFrame&) { ++sent_; });
    node_->on_link(now_, true, "");
  }
  void send(int left, int right) {
    node_->on_frame(
        now_, can::CanFrame::make(0x100, {static_cast<std::uint8_t>(left), static_cast<std::uint8_t>(left >> 8),
                                          static_cast<std::uint8_t>(right), static_cast<std::uint8_t>(right >> 8)}));
    node_->tick(now_);
    now_ += 10'000;
  }
  test::Recorder<wheels_t> recorder_{"WHEELS"};
  std::optional<EncoderNode> node_;
  std::int64_t now_ = 1'700'000'000'000'000;
  int sent_ = 0;
};

TEST_F(SignalNode, CountsOf16BitsBecomeWheelsThatGoForwardThroughTheirWrap) {
  make(SignalKind::kCounts);
  for (int i = 0; i < 1000; ++i) send(100 * i, -100 * i);
  const wheels_t& last = recorder_.messages().back();
  EXPECT_EQ(last.counts[0], 99'900);
  EXPECT_EQ(last.counts[1], 99'900);
  EXPECT_NEAR(last.speed[0], 1e4 * 2 * M_PI / 4096, 1e-6);
  EXPECT_FALSE(last.enabled) << "nobody says so";
  EXPECT_THAT(node_->report().faults, IsEmpty());
  EXPECT_EQ(sent_, 0);
}

TEST_F(SignalNode, AfterASilenceCountsBeginAnewAndNoSpeedIsMadeUp) {
  make(SignalKind::kCounts);
  for (int i = 0; i < 100; ++i) send(100 * i, 0);
  const wheels_t before = recorder_.messages().back();
  now_ += 3'000'000;
  for (int i = 0; i < 100; ++i) send(100 * i, 0);
  EXPECT_EQ(node_->report().counters["counts_restarted"], 1);
  for (const wheels_t& message : recorder_.messages()) EXPECT_NEAR(message.speed[0], 1e4 * 2 * M_PI / 4096, 1e-6);
  EXPECT_EQ(recorder_.messages().back().counts[0], before.counts[0] + 9'900);
}

TEST_F(SignalNode, SpeedsAreSummedToAngles) {
  make(SignalKind::kSpeeds);
  for (int i = 0; i < 500; ++i) send(5'000, -5'000);
  const wheels_t& last = recorder_.messages().back();
  EXPECT_NEAR(last.angle[0], 4.99 * 5, 1e-6);
  EXPECT_NEAR(last.angle[1], 4.99 * 5, 1e-6);
  EXPECT_EQ(last.speed[0], 5);
  EXPECT_EQ(last.counts[0], std::llround(4.99 * 5 * 4096 / (2 * M_PI)));
}

TEST_F(SignalNode, ASpeedThatNoWheelHasIsRefused) {
  EncoderConfig fast = config(SignalKind::kSpeeds);
  fast.signals.left = "100 0|16@1-";
  node_.emplace(fast, recorder_.bus());
  for (int i = 0; i < 100; ++i) send(i % 10 == 5 ? 30'000 : 5, 0);
  EXPECT_EQ(node_->report().counters["refused.jump"], 10);
  EXPECT_NEAR(recorder_.messages().back().angle[0], 0.99 * 5, 1e-6);
  for (int i = 0; i < 100; ++i) send(i % 10 == 5 ? 30'000 : 5, 0);
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("most of them refused.jump")));
}

TEST_F(SignalNode, SignalsThatAreNoneAreReportedWithTheirKey) {
  EncoderConfig wrong = config(SignalKind::kCounts);
  wrong.signals.right = "100 60|16@1-";
  try {
    node_.emplace(wrong, recorder_.bus());
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("encoder.signals.right: \"100 60|16@1-\": it does not fit"));
  }
  wrong.signals.right = "100 16|16@1- (2,0)";
  EXPECT_THROW(node_.emplace(wrong, recorder_.bus()), std::runtime_error);
  wrong.signals.right =
      wrong.signals.left;  // copied, and never corrected: by its wheels the vehicle drives straight on
  try {
    node_.emplace(wrong, recorder_.bus());
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("encoder.signals.right: \"" + wrong.signals.left + "\": it has bits of"));
  }
}

}  // namespace
}  // namespace curbstone::encoder::signals
