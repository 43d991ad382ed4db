// Frames of a drive whose digits an SLCAN adapter's line has damaged: the operator reads nothing that the drive did not
// say.
#include <gmock/gmock.h>

#include "drivers/encoder/encoder_node.hpp"
#include "tests/drivers/encoder/encoder_on_a_bus.hpp"

namespace curbstone::encoder {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A drive that another master has set up, far from where it was switched on, with one damaged frame after 2 s.
class DamagedStatus : public EncoderThatListens {
 protected:
  DamagedStatus() { rig_.first_count = 0x51'2345; }
  void drive(double seconds, const std::function<void(can::CanFrame&)>& damage = {}) {
    for (int i = 0; i < static_cast<int>(10 * seconds); ++i) {
      send(0.1, 10'000);
      can::CanFrame status = can::CanFrame::make(0x281, {0x27, 0x14, 0x27, 0x14, 0xBB, 0x03, 0x45, 0xFC});
      if (i == 0 && damage) damage(status);
      rig_.node.on_frame(static_cast<std::int64_t>(at_) - 5000, status);
    }
  }
  [[nodiscard]] bool all_enabled() {
    const auto& messages = rig_.messages();
    return std::all_of(messages.begin() + 60, messages.end(), [](const wheels_t& m) { return m.enabled; });
  }
};

TEST_F(DamagedStatus, AnyBitOfAStatusWordIsNoAlarmAndStopsNoWheel) {
  for (int bit = 0; bit < 32; ++bit) {
    drive(1.0);
    drive(0.1, [&](can::CanFrame& frame) {
      frame.data[static_cast<std::size_t>(bit / 8)] ^= static_cast<std::uint8_t>(1 << bit % 8);
    });
    EXPECT_THAT(faults(), IsEmpty()) << bit;
  }
  drive(1.0);
  EXPECT_TRUE(all_enabled());
}

TEST_F(DamagedStatus, AnAlarmThatStaysIsTold) {
  drive(2.0);
  for (int i = 0; i < 2; ++i) drive(0.1, [](can::CanFrame& frame) { frame.data[0] = 0xA8; });
  EXPECT_THAT(faults(), Contains("drive, left wheel: alarm (status word 14A8)"));
}

TEST_F(DamagedStatus, PositionsUnderTheIdOfAnEmergencyAreNone) {
  drive(2.0);
  can::CanFrame frame = positions(static_cast<std::int64_t>(at_));
  frame.id = 0x081;
  rig_.node.on_frame(static_cast<std::int64_t>(at_), frame);
  drive(2.0);
  EXPECT_THAT(faults(), IsEmpty());
  EXPECT_EQ(rig_.count("refused.emergency"), 1);
  EXPECT_EQ(rig_.count("drive.emergencies"), 0);
  EXPECT_TRUE(all_enabled());
}

TEST_F(DamagedStatus, AStatusUnderTheIdOfAnEmergencyIsNone) {
  drive(2.0);
  drive(0.1, [](can::CanFrame& frame) { frame.id = 0x081; });
  drive(1.0);
  EXPECT_THAT(faults(), IsEmpty());
  EXPECT_EQ(rig_.count("refused.emergency"), 1);
}

TEST_F(DamagedStatus, PositionsUnderTheIdOfAStatusStopNoWheel) {
  drive(2.0);
  can::CanFrame frame = positions(static_cast<std::int64_t>(at_));
  frame.id = 0x281;
  rig_.node.on_frame(static_cast<std::int64_t>(at_), frame);
  EXPECT_THAT(faults(), IsEmpty());
  drive(2.0);
  EXPECT_TRUE(all_enabled());
}

/// "No error" with a damaged digit in its code: its register has none either.
TEST_F(DamagedStatus, AnEndOfAnEmergencyWithADamagedCodeIsNoEmergency) {
  drive(2.0);
  for (int bit = 0; bit < 16; ++bit) {
    can::CanFrame frame = can::CanFrame::make(0x081, {0, 0, 0, 0, 0, 0, 0, 0});
    frame.data[static_cast<std::size_t>(bit / 8)] ^= static_cast<std::uint8_t>(1 << bit % 8);
    rig_.node.on_frame(static_cast<std::int64_t>(at_), frame);
    EXPECT_THAT(faults(), IsEmpty()) << bit;
  }
  EXPECT_EQ(rig_.count("refused.emergency"), 16);
}

/// What is refused is named by its own cause.
TEST_F(DamagedStatus, ManyHeartbeatsOfNoStateAreNamedSo) {
  for (int i = 0; i < 40; ++i) {
    drive(0.1);
    for (int k = 0; k < 3; ++k)
      rig_.node.on_frame(static_cast<std::int64_t>(at_) - 4000, can::CanFrame::make(0x701, {0x33}));
  }
  EXPECT_THAT(faults(), Contains(HasSubstr("refused.heartbeat")));
}

}  // namespace
}  // namespace curbstone::encoder
