#include "drivers/encoder/signals/wheel_signals.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <tuple>

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
  const auto counts = [&](int left, int right) { return wheels.on_frame(0, word(0x100, left | right << 8))->counts; };
  const auto first = counts(250, 5);
  const auto second = counts(4, 250);
  EXPECT_EQ(second[0] - first[0], 10);
  EXPECT_EQ(second[1] - first[1], -11);
}

TEST(WheelSignalsTest, WheelsInTwoFramesMakeAPairWhenBothHaveCome) {
  WheelSignals wheels(CanSignal::parse("100 0|16@1-"), CanSignal::parse("101 0|16@1-"));
  EXPECT_FALSE(wheels.on_frame(0, word(0x100, 1)));
  ASSERT_TRUE(wheels.on_frame(300, word(0x101, 2)));
  EXPECT_FALSE(wheels.on_frame(10'300, word(0x101, 3))) << "its other half is lost";
  EXPECT_FALSE(wheels.on_frame(20'000, word(0x100, 4)));
  EXPECT_FALSE(wheels.on_frame(30'000, word(0x100, 5)));
  const auto pair = wheels.on_frame(30'300, word(0x101, 6));
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->counts, (std::array<std::int32_t, 2>{5, 6}));
  EXPECT_EQ(wheels.counters()["lost.halves"], 2);
  EXPECT_FALSE(wheels.on_frame(30'400, word(0x102, 1)));
  EXPECT_EQ(wheels.counters()["ignored.frames"], 1);
  EXPECT_FALSE(wheels.on_frame(40'000, can::CanFrame::make(0x100, {1})));
  EXPECT_EQ(wheels.counters()["refused.length"], 1);
}

/// Which wheel's frame leads is learnt: a pair of two times is out by as much as the wheels turn in a period.
class HalvesThatAreLost : public ::testing::TestWithParam<std::tuple<int, int, int>> {};

TEST_P(HalvesThatAreLost, MakeNoPairOfTwoTimes) {
  const auto [leads, joins, apart] = GetParam();  // wheel, wheel, us
  WheelSignals wheels(CanSignal::parse("100 0|16@1+"), CanSignal::parse("101 0|16@1+"));
  std::mt19937 random(1);
  int lost_pairs = 0, pairs = 0, wrong = 0, wrong_late = 0;
  for (int i = 0; i < 2000; ++i) {
    bool whole = true;
    const auto late = static_cast<std::int64_t>(random() % 1000);  // the host
    for (int half = 0; half < 2; ++half) {
      const int wheel = half == 0 ? leads : 1 - leads;
      const bool lost = i > 2 && random() % 50 == 0;
      if (lost || (i == 0 && half == 0 && joins != leads)) {
        whole = false;
        continue;
      }
      const std::int64_t time = i * 10'000 + half * apart + late + static_cast<std::int64_t>(random() % 100);
      const auto pair = wheels.on_frame(time, word(wheel == 0 ? 0x100 : 0x101, i));
      if (!pair) continue;
      ++pairs;
      wrong += pair->counts[0] != pair->counts[1] ? 1 : 0;
      wrong_late += i > 10 && pair->counts[0] != pair->counts[1] ? 1 : 0;
    }
    lost_pairs += whole ? 0 : 1;
  }
  EXPECT_LE(wrong, joins == leads ? 0 : 1);
  EXPECT_EQ(wrong_late, 0);
  EXPECT_NEAR(pairs, 2000 - lost_pairs, 2);
}
INSTANTIATE_TEST_SUITE_P(Orders, HalvesThatAreLost,
                         ::testing::Combine(::testing::Values(0, 1), ::testing::Values(0, 1),
                                            ::testing::Values(300, 1000, 2000)));

TEST(WheelSignalsTest, AFrameThatIsTooShortForOneOfItsWheelsIsRefusedWhole) {
  WheelSignals wheels(CanSignal::parse("100 0|16@1-"), CanSignal::parse("100 16|16@1-"));
  ASSERT_TRUE(wheels.on_frame(0, can::CanFrame::make(0x100, {1, 0, 2, 0})));
  EXPECT_FALSE(wheels.on_frame(10'000, can::CanFrame::make(0x100, {9, 0, 9})));
  const auto pair = wheels.on_frame(20'000, can::CanFrame::make(0x100, {3, 0, 4, 0}));
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->counts, (std::array<std::int32_t, 2>{3, 4}));
  EXPECT_EQ(wheels.counters()["refused.length"], 1);
  EXPECT_EQ(wheels.counters()["lost.halves"], 0);
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
    node_->on_link(now_, link::LinkState::kUp, "");
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

/// A frame each, one of a hundred lost: the wheels turn alike all the same, and no stamp is off.
TEST_F(SignalNode, WheelsInTwoFramesOfWhichSomeAreLostStayTogether) {
  EncoderConfig two = config(SignalKind::kCounts);
  two.signals.left = "100 0|16@1+";
  two.signals.right = "101 0|16@1+";
  two.invert_right = false;
  node_.emplace(two, recorder_.bus());
  std::mt19937 random(1);
  int lost = 0;
  for (int i = 0; i < 6000; ++i, now_ += 10'000) {
    const int count = 60 * i + static_cast<int>(std::lround(1500 * std::sin(0.02 * i)));
    const bool first = i > 100 && random() % 100 == 0, second = i > 100 && random() % 100 == 0;
    lost += first || second ? 1 : 0;
    if (!first) node_->on_frame(now_ + 200, word(0x100, count & 0xFFFF));
    if (!second) node_->on_frame(now_ + 500, word(0x101, count & 0xFFFF));
    node_->tick(now_ + 600);
  }
  node_->finish();
  const std::int64_t unsure = node_->report().counters["withheld.unsure"];  // between two losses
  EXPECT_NEAR(static_cast<double>(node_->report().counters["lost.samples"]), lost, 3);
  EXPECT_LT(unsure, 100);
  EXPECT_EQ(static_cast<std::int64_t>(recorder_.messages().size()), 5999 - lost - unsure);
  EXPECT_EQ(node_->report().counters["counts_restarted"], 0) << "nothing was before";
  for (const wheels_t& message : recorder_.messages()) {
    EXPECT_EQ(message.counts[0], message.counts[1]);
    EXPECT_EQ((message.utime - 1'700'000'000'000'500) % 10'000, 0);
  }
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
