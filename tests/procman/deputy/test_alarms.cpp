#include "procman/deputy/alarms.hpp"

#include <gmock/gmock.h>

#include "tests/stamps.hpp"

namespace curbstone::procman::deputy {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using test::kSecond;

struct Vehicle {
  process::CommandState mapper;
  Alarms alarms;
  Vehicle() { mapper.command.id = "mapper"; }
  std::vector<std::string> faults(std::int64_t now) { return alarms.faults({&mapper}, now); }
};

TEST(Alarms, OneDeathIsNone) {
  Vehicle v;
  v.alarms.ended(v.mapper, "Killed after 8.0 s", kSecond);
  EXPECT_THAT(v.faults(2 * kSecond), IsEmpty());
}

TEST(Alarms, FiveInAMinuteAreACrashLoopUntilItIsOver) {
  Vehicle v;
  for (int i = 1; i <= 5; ++i) v.alarms.ended(v.mapper, "Aborted after 3.0 s", i * 10 * kSecond);
  EXPECT_THAT(v.faults(51 * kSecond),
              ElementsAre(HasSubstr("mapper keeps dying: 5 times in the last minute (Aborted")));
  EXPECT_THAT(v.faults(80 * kSecond), IsEmpty());
}

TEST(Alarms, WhoWasToldToStopHasNotDied) {
  Vehicle v;
  v.mapper.stopping = true;
  for (int i = 1; i <= 9; ++i) v.alarms.ended(v.mapper, "exit status 0 after 3.0 s", i * kSecond);
  EXPECT_THAT(v.faults(10 * kSecond), IsEmpty());
}

TEST(Alarms, ARefusedConfigurationIsSaidForAsLongAsItIsSo) {
  Vehicle v;
  v.mapper.refused = true;
  v.alarms.ended(v.mapper, "exit status 2 after 0.1 s", kSecond);
  EXPECT_THAT(v.faults(1000 * kSecond), ElementsAre(HasSubstr("mapper: wrong configuration")));
  v.mapper.refused = false;
  EXPECT_THAT(v.faults(1001 * kSecond), IsEmpty());
}

TEST(Alarms, ASilenceIsSaidForAMinute) {
  Vehicle v;
  v.alarms.silent("mapper", 10, 5 * kSecond);
  EXPECT_THAT(v.faults(60 * kSecond), ElementsAre("mapper was silent for 10 s and was replaced"));
  EXPECT_THAT(v.faults(66 * kSecond), IsEmpty());
}

}  // namespace
}  // namespace curbstone::procman::deputy
