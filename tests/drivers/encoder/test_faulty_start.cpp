// One frame of a drive's start that is lost, doubled, late or damaged, each in its turn: the drive is set up all the
// same.
#include <cmath>

#include "tests/drivers/encoder/encoder_on_a_bus.hpp"

namespace curbstone::encoder {
namespace {

using can::CanFrame;
using ::testing::IsEmpty;

enum class Fault { kLost, kDoubled, kLate, kVeryLate, kCut, kAnotherByte };

class FaultyStart : public ::testing::TestWithParam<Fault> {
 protected:
  struct Drive : EncoderOnABus {
    using EncoderOnABus::counters;
    using EncoderOnABus::faults;
    using EncoderOnABus::rig_;
    void TestBody() override {}
  };
};

TEST_P(FaultyStart, EndsWithATrueDrive) {
  for (int faulty = 0; faulty < 80; ++faulty) {
    SCOPED_TRACE(faulty);
    Drive d;
    auto& rig = d.rig_;
    int number = -1;
    const auto is_it = [&] { return number == faulty; };
    rig.lost = [&](const CanFrame&) {
      ++number;
      return is_it() && GetParam() == Fault::kLost;
    };
    rig.copies = [&](const CanFrame&) { return is_it() && GetParam() == Fault::kDoubled ? 2 : 1; };
    rig.delay = [&](const CanFrame&) -> std::int64_t {
      return !is_it() ? 200 : GetParam() == Fault::kLate ? 30'000 : GetParam() == Fault::kVeryLate ? 700'000 : 200;
    };
    rig.corrupt = [&](CanFrame& frame) {
      if (!is_it() || frame.size == 0) return;
      if (GetParam() == Fault::kCut) frame.size = static_cast<std::uint8_t>(frame.size / 2);
      if (GetParam() == Fault::kAnotherByte) frame.data[0] ^= 0x41;
    };
    rig.receive(rig.now, rig.drive.power_on(rig.now));
    rig.drive.set_speeds(955, -955);
    rig.run_for(6'000'000);
    EXPECT_THAT(d.faults(), IsEmpty()) << d.counters();
    ASSERT_GT(rig.messages().size(), 300U) << d.counters();
    EXPECT_LT(rig.now - rig.messages().back().utime, 100'000);
    const wheels_t& last = rig.messages().back();
    for (const wheels_t& m : rig.messages()) {
      ASSERT_TRUE(std::abs(m.speed[0] - 10) < 0.8 || m.speed[0] == 0) << m.speed[0] << "\n" << d.counters();
      ASSERT_NEAR(m.angle[0] - last.angle[0], rig.angle(m.utime) - rig.angle(last.utime), 0.02) << d.counters();
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Of, FaultyStart,
                         ::testing::Values(Fault::kLost, Fault::kDoubled, Fault::kLate, Fault::kVeryLate, Fault::kCut,
                                           Fault::kAnotherByte));

}  // namespace
}  // namespace curbstone::encoder
