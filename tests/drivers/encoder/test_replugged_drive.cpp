// An adapter that is unplugged, and plugged in again: where it was, or at another drive.
#include <cmath>

#include "tests/drivers/encoder/encoder_on_a_bus.hpp"

namespace curbstone::encoder {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RepluggedDrive : public EncoderOfADrive {
 protected:
  void unplug(std::int64_t us) {
    rig_.node.on_link(rig_.now, link::LinkState::kDown, "serial port /dev/x has vanished");
    rig_.connected = false;
    rig_.run_for(us);
  }
  void plug_in() {
    rig_.connected = true;
    rig_.node.on_link(rig_.now, link::LinkState::kUp, "");
  }
  [[nodiscard]] std::size_t sent() { return rig_.messages().size(); }
};

/// Its counts differ by a distance that a wheel can go meanwhile.
TEST_F(RepluggedDrive, AnotherOneWithOtherCountsMovesNoAngle) {
  for (const std::int64_t difference : {20'000, -20'000, 500, -200'000}) {
    const std::size_t before = sent();
    const wheels_t last = rig_.messages().back();
    unplug(3'000'000);
    rig_.first_count += difference;
    plug_in();
    rig_.run_for(3'000'000);
    ASSERT_GT(sent(), before + 200);
    for (std::size_t i = before; i < sent(); ++i) {
      const wheels_t& m = rig_.messages()[i];
      ASSERT_TRUE(std::abs(m.speed[0] - 10) < 0.8 || m.speed[0] == 0) << m.speed[0];
      ASSERT_LT(std::abs(m.angle[0] - last.angle[0]), 10 * static_cast<double>(m.utime - last.utime) * 1e-6 + 1);
    }
    EXPECT_LT(rig_.messages().back().angle[0] - last.angle[0], 31) << "the distance without the adapter is lost";
    EXPECT_THAT(faults(), IsEmpty());
  }
  EXPECT_EQ(rig_.count("counts_restarted"), 4);
}

/// What the drive said of itself before says nothing of now.
TEST_F(RepluggedDrive, FaultsThatNobodyCanReadAnyMoreAreNotReported) {
  rig_.receive(rig_.now, rig_.drive.set_faults(0x0001, 0));
  rig_.run_for(3'000'000);
  ASSERT_THAT(faults(), Contains(HasSubstr("left wheel: over-voltage")));
  unplug(10'000'000);
  EXPECT_THAT(faults(), Not(Contains(HasSubstr("over-voltage"))));
  plug_in();
  rig_.run_for(3'000'000);
  EXPECT_THAT(faults(), Contains(HasSubstr("left wheel: over-voltage")));
}

}  // namespace
}  // namespace curbstone::encoder
