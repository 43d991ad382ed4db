// A digit that an SLCAN adapter's line damages in what the drive says of itself.
#include <gmock/gmock.h>

#include "tests/drivers/encoder/encoder_on_a_bus.hpp"

namespace curbstone::encoder {
namespace {

using can::CanFrame;
using ::testing::IsEmpty;

class DamagedReplies : public EncoderOfADrive {
 protected:
  /// Damages the next frame that `is_it` chooses, and only that.
  void damage_next(const std::function<bool(const CanFrame&)>& is_it, std::size_t byte, std::uint8_t bits) {
    rig_.corrupt = [is_it, byte, bits, done = false](CanFrame& frame) mutable {
      if (done || !is_it(frame)) return;
      done = true;
      frame.data[byte] ^= bits;
    };
  }
  /// Runs on and looks for faults ten times a second, as nobody else does.
  void expect_no_fault_for(int tenths) {
    for (int i = 0; i < tenths; ++i) {
      rig_.run_for(100'000);
      EXPECT_THAT(faults(), IsEmpty()) << i;
    }
  }
  static bool is_heartbeat(const CanFrame& frame) { return frame.id == 0x701; }
  static auto is_reply_of(std::uint8_t low, std::uint8_t high) {
    return [low, high](const CanFrame& frame) {
      return frame.id == 0x581 && frame.data[1] == low && frame.data[2] == high;
    };
  }
};

TEST_F(DamagedReplies, AHeartbeatOfAnotherStateStopsNothing) {
  for (const int bits : {0x01, 0x7A, 0x30, 0x04}) {  // stopped, pre-operational, and no states
    damage_next(is_heartbeat, 0, static_cast<std::uint8_t>(bits));
    expect_no_fault_for(10);
  }
  EXPECT_EQ(rig_.count("drive.stops"), 0) << counters();
  EXPECT_EQ(rig_.count("refused.heartbeat"), 2);
  EXPECT_EQ(rig_.count("lost.samples") + rig_.count("withheld.unsure"), 0) << counters();
  expect_true_messages();
}

TEST_F(DamagedReplies, AHeartbeatThatBecameABootUpLosesNoDistance) {
  damage_next(is_heartbeat, 0, 0x05);
  rig_.run_for(3'000'000);
  EXPECT_EQ(rig_.count("drive.boots"), 2) << "the first one was one";
  EXPECT_THAT(faults(), IsEmpty());
  EXPECT_GT(rig_.messages().size(), 450U);
  expect_true_messages();
}

TEST_F(DamagedReplies, AFaultWordThatIsReadOnceIsNoFault) {
  damage_next(is_reply_of(0x3F, 0x60), 4, 0x08);
  expect_no_fault_for(30);
  for (const wheels_t& message : rig_.messages()) ASSERT_EQ(message.faults[0], 0);
}

TEST_F(DamagedReplies, EncoderLinesThatAreReadOnceAreNotBelieved) {
  rig_.receive(rig_.now, rig_.drive.power_on(rig_.now));
  rig_.node.on_link(rig_.now, link::LinkState::kUp, "");
  rig_.drive.set_speeds(955, -955);
  damage_next(is_reply_of(0x0E, 0x20), 5, 0x01);
  rig_.run_for(1'000'000);
  EXPECT_THAT(faults(), IsEmpty());
}

/// What the drive says by itself in any order, with any content: no wrong speed, and afterwards no fault that stays.
TEST_F(DamagedReplies, HostileSequencesEndWithATrueDrive) {
  std::mt19937 random(21);
  for (int round = 0; round < 20; ++round) {
    for (int i = 0; i < 100; ++i) {
      rig_.run_for(1000 * static_cast<std::int64_t>(random() % 20));
      const std::array<std::uint32_t, 5> ids = {0x701, 0x081, 0x581, 0x582, 0x281};
      CanFrame frame = CanFrame::make(ids[random() % ids.size()], {0, 0, 0, 0, 0, 0, 0, 0});
      for (std::uint8_t& byte : frame.data) byte = static_cast<std::uint8_t>(random() % 4 == 0 ? random() : 0);
      if (frame.id == 0x701) frame.size = 1;
      if (frame.id == 0x701 && frame.data[0] == 0) frame.data[0] = 0x04;  // a boot-up is one
      if (frame.id == 0x581 && random() % 2 == 0) frame.data = {0x80, 0x3F, 0x60, 0, 0, 0, 0x02, 0x06};
      rig_.node.on_frame(rig_.now, frame);
    }
    rig_.run_for(8'000'000);
    EXPECT_THAT(faults(), IsEmpty()) << round << "\n" << counters();
  }
  for (const wheels_t& m : rig_.messages())
    ASSERT_TRUE(std::abs(m.speed[0] - 10) < 0.8 || m.speed[0] == 0) << m.speed[0] << "\n" << counters();
}

}  // namespace
}  // namespace curbstone::encoder
