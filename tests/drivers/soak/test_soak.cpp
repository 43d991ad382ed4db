#include <gmock/gmock.h>

#include <cstdint>
#include <cstdlib>

#include "tests/drivers/soak/soak.hpp"

namespace curbstone::test {
namespace {

using ::testing::AnyOf;
using ::testing::Each;
using ::testing::HasSubstr;

constexpr double kMinute = 1.0 / 60;
#ifdef CURBSTONE_SANITIZED
constexpr std::int64_t kFlat = INT64_MAX;  // a sanitizer keeps what is freed
#else
constexpr std::int64_t kFlat = 4 << 20;  // bytes: what an allocator keeps for itself
#endif

/// Every good packet is used once, no stamp is off by a millisecond, memory is flat, faults are of refused packets
/// only.
void expect_undisturbed(const Soak& soak) {
  const Ledger& ledger = soak.ledger;
  EXPECT_GT(ledger.sent(Fate::kCorrupt), 10);
  EXPECT_EQ(ledger.used(Fate::kGood), ledger.sent(Fate::kGood));
  EXPECT_EQ(ledger.used(Fate::kDoubled), ledger.sent(Fate::kDoubled));
  EXPECT_EQ(ledger.strange(), 0);
  EXPECT_LE(std::abs(ledger.worst_error()), 1000) << "us";
  EXPECT_LE(ledger.growth(), kFlat);
}

TEST(Soak, AnXsensOnABadLine) {
  const Soak soak = soak_xsens(kMinute);
  expect_undisturbed(soak);
  const Counters& counters = soak.report.counters;
  EXPECT_EQ(counters["refused.repeated"], soak.ledger.sent(Fate::kDoubled));
  EXPECT_EQ(counters["refused.late"], soak.ledger.sent(Fate::kSwapped)) << "a line that carries bytes cannot swap them";
  EXPECT_EQ(counters["lost.packets"], soak.ledger.sent(Fate::kCorrupt) + soak.ledger.sent(Fate::kCut));
  EXPECT_EQ(counters["refused.time"], 0);
  EXPECT_EQ(counters["clock_restarts"], 0);
  EXPECT_THAT(soak.ledger.faults(), Each(HasSubstr("of the packets of a second were refused")));
}

TEST(Soak, AWheelDriveOnABadBus) {
  const Soak soak = soak_can(kMinute);
  expect_undisturbed(soak);
  const Counters& counters = soak.report.counters;
  EXPECT_EQ(soak.ledger.used(Fate::kSwapped), soak.ledger.sent(Fate::kSwapped));
  EXPECT_EQ(counters["refused.jump"], soak.ledger.sent(Fate::kCorrupt));
  EXPECT_EQ(counters["refused.length"], soak.ledger.sent(Fate::kCut));
  EXPECT_EQ(counters["refused.repeated"], soak.ledger.sent(Fate::kDoubled));
  EXPECT_THAT(soak.ledger.faults(), Each(HasSubstr("of the packets of a second were refused")));
}

TEST(Soak, AWitMotionOnABadLine) {
  const Soak soak = soak_witmotion(kMinute);
  expect_undisturbed(soak);
  const Counters& counters = soak.report.counters;
  EXPECT_EQ(counters["refused.repeated"], soak.ledger.sent(Fate::kDoubled));
  EXPECT_EQ(counters["clock_restarts"], 0);
  EXPECT_THAT(soak.ledger.faults(), Each(HasSubstr("of the packets of a second were refused")));
}

TEST(Soak, AWheelDriveOnABadModbusLine) {
  const Soak soak = soak_modbus(kMinute);
  expect_undisturbed(soak);
  const Counters& counters = soak.report.counters;
  EXPECT_EQ(soak.ledger.used(Fate::kCorrupt) + soak.ledger.used(Fate::kCut) + soak.ledger.used(Fate::kSwapped), 0);
  EXPECT_GE(counters["refused.unasked"], soak.ledger.sent(Fate::kDoubled));
  EXPECT_EQ(counters["refused.jump"], 0) << "a reply to another request is never taken for positions";
  EXPECT_EQ(counters["counts_restarted"], 0);
  EXPECT_THAT(soak.ledger.faults(), Each(HasSubstr("of the packets of a second were refused")));
}

void expect_lidar(const Soak& soak) {
  expect_undisturbed(soak);
  const Counters& counters = soak.report.counters;
  const auto& ledger = soak.ledger;
  EXPECT_EQ(counters["refused.length"], ledger.sent(Fate::kCut));
  EXPECT_EQ(counters["refused.duplicate"], ledger.sent(Fate::kDoubled));
  EXPECT_EQ(counters["refused.late"] + ledger.used(Fate::kSwapped), ledger.sent(Fate::kSwapped));
  EXPECT_GT(20 * ledger.used(Fate::kSwapped), 19 * ledger.sent(Fate::kSwapped)) << "put in order, unless more is wrong";
  EXPECT_EQ(counters["refused.magic"] + counters["refused.block"] + counters["refused.azimuth"] +
                counters["refused.stamp"] + ledger.used(Fate::kCorrupt),
            ledger.sent(Fate::kCorrupt));
  EXPECT_THAT(ledger.faults(), Each(AnyOf(HasSubstr("of the packets of a second were refused"),
                                          HasSubstr("packets were lost in a second"))));
}

TEST(Soak, AnRs16OnABadNetwork) {
  expect_lidar(soak_rs16(kMinute));
}

TEST(Soak, AVlp16OnABadNetwork) {
  expect_lidar(soak_vlp16(kMinute));
}

TEST(Soak, AHelios32OnABadNetwork) {
  expect_lidar(soak_helios32(kMinute));
}

}  // namespace
}  // namespace curbstone::test
