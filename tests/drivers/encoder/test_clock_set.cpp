// The host's clock is set while the wheels turn: a moment is lost, and the stamps follow.
#include "tests/drivers/encoder/encoder_on_a_bus.hpp"

namespace curbstone::encoder {
namespace {

class EncoderOnASetClock : public EncoderOfADrive, public ::testing::WithParamInterface<double> {};

TEST_P(EncoderOnASetClock, LosesAMomentAndFollows) {
  rig_.run_for(6'000'000);
  const std::size_t before = rig_.messages().size();
  const double first = rig_.angle(rig_.messages()[0].utime) - rig_.messages()[0].angle[0];
  rig_.host_set_by = std::llround(GetParam() * 1e6);
  const std::int64_t set_at = rig_.now + rig_.host_set_by;
  rig_.run_for(8'000'000);
  EXPECT_GE(rig_.messages().size() - before, 780U) << counters();
  for (std::size_t i = before; i < rig_.messages().size(); ++i) {
    const wheels_t& m = rig_.messages()[i];
    if (std::abs(m.utime - set_at) < 300'000 || m.utime < set_at) continue;
    ASSERT_NEAR(m.angle[0], rig_.angle(m.utime - rig_.host_set_by) - first, 0.05) << i << "\n" << counters();
    ASSERT_NEAR(m.speed[0], 10, 0.5) << i;
  }
}
INSTANTIATE_TEST_SUITE_P(By, EncoderOnASetClock, ::testing::Values(-3600, -1, -0.5, -0.05, 0.06, 0.5, 1, 3600));

TEST_F(EncoderOfADrive, IsAskedForItsFaultsAfterTheHostsClockWasSetBackToo) {
  rig_.run_for(6'000'000);
  rig_.host_set_by = -3'600'000'000;
  rig_.run_for(3'000'000);
  (void)rig_.drive.set_faults(0, 0x0404);  // the emergency message is lost
  rig_.run_for(5'000'000);
  EXPECT_EQ(rig_.messages().back().faults[wheels_t::RIGHT], 0x0404);
}

}  // namespace
}  // namespace curbstone::encoder
