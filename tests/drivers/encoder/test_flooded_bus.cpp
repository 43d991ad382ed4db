// A bus that is full: of other nodes' frames, and of the drive's own.
#include <gmock/gmock.h>

#include "tests/drivers/encoder/encoder_on_a_bus.hpp"

namespace curbstone::encoder {
namespace {

using can::CanFrame;
using ::testing::IsEmpty;

class FloodedBus : public EncoderOfADrive {};

struct EncoderThatListensNow : EncoderThatListens {
  using EncoderOnABus::counters;
  using EncoderOnABus::rig_;
  using EncoderThatListens::at_;
  using EncoderThatListens::send;
  explicit EncoderThatListensNow(double speed) { rig_.speed = speed; }
  void TestBody() override {}
};

/// 8000 frames a second: 1 Mbit/s has room for no more.
TEST_F(FloodedBus, FramesOfOtherNodesCostNothing) {
  std::mt19937 random(2);
  for (int ms = 0; ms < 5000; ++ms) {
    rig_.run_for(1000);
    for (int i = 0; i < 8; ++i) {
      CanFrame frame = CanFrame::make(0x002 + static_cast<std::uint32_t>(random() % 0x7F0), {1, 2, 3, 4, 5, 6, 7, 8});
      if ((frame.id & 0x7F) == 1) ++frame.id;
      rig_.node.on_frame(rig_.now, frame);
    }
  }
  EXPECT_THAT(faults(), IsEmpty());
  EXPECT_EQ(rig_.count("lost.samples") + rig_.count("withheld.unsure"), 0) << counters();
  expect_true_messages();
}

/// Another master has taken the inhibit time away: the drive sends each change, up to once a millisecond, and while it
/// stands the noise of a count.
TEST_F(FloodedBus, PositionsWithoutAnInhibitTimeAreAsTrueAsOthers) {
  for (const double speed : {0.0, 10.0}) {
    SCOPED_TRACE(speed);
    EncoderThatListensNow listener(speed);
    listener.send(3, 10'000);
    listener.send(5, 1'000);
    listener.send(5, 10'000);
    const auto& messages = listener.rig_.messages();
    EXPECT_GT(messages.size(), 1000U) << listener.counters();
    for (const wheels_t& m : messages) {
      ASSERT_NEAR(m.angle[0], listener.rig_.angle(m.utime) - listener.rig_.angle(messages[0].utime), 0.014)
          << seconds_of(m) << "\n"
          << listener.counters();
    }
    EXPECT_NEAR(static_cast<double>(messages.back().utime), listener.at_, 21'000);
  }
}

}  // namespace
}  // namespace curbstone::encoder
