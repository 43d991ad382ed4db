#include "procman/deputy/heartbeats.hpp"

#include <gmock/gmock.h>

#include "tests/stamps.hpp"

namespace curbstone::procman::deputy {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using test::kSecond;
constexpr std::int64_t kStart = 1000 * kSecond;

/// Looks every half second, as a loop does, until `to`. What was silent is in the order in which it was found.
std::vector<std::string> look(Heartbeats& heartbeats, std::int64_t from, std::int64_t to) {
  std::vector<std::string> all;
  for (std::int64_t now = from; now <= to; now += kSecond / 2)
    for (const std::string& id : heartbeats.take_timed_out(now)) all.push_back(id);
  return all;
}

TEST(Heartbeats, ACommandThatSpeaksIsLeftAlone) {
  Heartbeats heartbeats;
  heartbeats.begin("a", 3, kStart);
  for (std::int64_t now = kStart; now < kStart + 100 * kSecond; now += kSecond) {
    heartbeats.on_status("a", true, now);
    EXPECT_THAT(look(heartbeats, now, now + kSecond / 2), IsEmpty());
  }
}

TEST(Heartbeats, ACommandThatFallsSilentIsTakenOnce) {
  Heartbeats heartbeats;
  heartbeats.begin("a", 3, kStart);
  heartbeats.on_status("a", true, kStart + kSecond);
  EXPECT_THAT(look(heartbeats, kStart + kSecond, kStart + 4 * kSecond), IsEmpty());
  EXPECT_THAT(look(heartbeats, kStart + 4 * kSecond, kStart + 60 * kSecond), ElementsAre("a"));
  heartbeats.begin("a", 3, kStart + 61 * kSecond);
  heartbeats.on_status("a", true, kStart + 61 * kSecond);
  EXPECT_THAT(look(heartbeats, kStart + 61 * kSecond, kStart + 70 * kSecond), ElementsAre("a")) << "its next life";
}

TEST(Heartbeats, TheFirstWordMayTakeHalfAMinute) {
  Heartbeats heartbeats;
  heartbeats.begin("a", 3, kStart);
  EXPECT_THAT(look(heartbeats, kStart, kStart + 30 * kSecond), IsEmpty());
  EXPECT_FALSE(heartbeats.alive("a"));
  EXPECT_THAT(look(heartbeats, kStart + 30 * kSecond, kStart + 32 * kSecond), ElementsAre("a"));
}

TEST(Heartbeats, WhileTheDeputyItselfSleepsNobodyIsHeldSilent) {
  Heartbeats heartbeats;
  heartbeats.begin("a", 3, kStart);
  heartbeats.on_status("a", true, kStart);
  EXPECT_THAT(look(heartbeats, kStart, kStart + 2 * kSecond), IsEmpty());
  EXPECT_THAT(look(heartbeats, kStart + 100 * kSecond, kStart + 101 * kSecond), IsEmpty());
  EXPECT_THAT(look(heartbeats, kStart + 101 * kSecond, kStart + 105 * kSecond), ElementsAre("a"));
}

TEST(Heartbeats, WhileTheDeputyDoesNotHearItselfTheBusIsSilentAndNotTheCommands) {
  Heartbeats heartbeats;
  heartbeats.begin("a", 3, kStart);
  for (int i = 0; i < 3; ++i) {
    heartbeats.on_own_status(kStart + i * kSecond);
    heartbeats.on_status("a", true, kStart + i * kSecond);
    EXPECT_THAT(look(heartbeats, kStart + i * kSecond, kStart + i * kSecond + kSecond / 2), IsEmpty());
  }
  EXPECT_THAT(look(heartbeats, kStart + 3 * kSecond, kStart + 60 * kSecond), IsEmpty());
  EXPECT_TRUE(heartbeats.is_bus_silent(kStart + 60 * kSecond));
  EXPECT_THAT(heartbeats.overdue(kStart + 60 * kSecond), IsEmpty());

  heartbeats.on_own_status(kStart + 60 * kSecond);
  EXPECT_FALSE(heartbeats.is_bus_silent(kStart + 60 * kSecond));
  std::vector<std::string> silent;
  for (int i = 60; i < 70; ++i) {
    heartbeats.on_own_status(kStart + i * kSecond);
    for (const std::string& id : look(heartbeats, kStart + i * kSecond, kStart + i * kSecond + kSecond / 2))
      silent.push_back(id);
    if (i <= 62) {
      EXPECT_THAT(silent, IsEmpty()) << "its silence begins when the bus is back";
    }
  }
  EXPECT_THAT(silent, ElementsAre("a")) << "this one does hang";
}

TEST(Heartbeats, ReadyIsWhoHasSaidThatNothingIsWrong) {
  Heartbeats heartbeats;
  EXPECT_TRUE(heartbeats.ready("nobody")) << "who is not watched need not speak";
  heartbeats.begin("a", 3, kStart);
  EXPECT_FALSE(heartbeats.ready("a"));
  heartbeats.on_status("a", false, kStart);
  EXPECT_TRUE(heartbeats.alive("a"));
  EXPECT_FALSE(heartbeats.ready("a"));
  heartbeats.on_status("a", true, kStart);
  heartbeats.on_status("a", false, kStart);
  EXPECT_TRUE(heartbeats.ready("a"));
  heartbeats.begin("a", 3, kStart);
  EXPECT_FALSE(heartbeats.ready("a")) << "in its next life it has said nothing yet";
}

TEST(Heartbeats, ACommandThatFallsSilentIsNamedWhileItIsAndBeforeItIsTaken) {
  Heartbeats heartbeats;
  heartbeats.begin("a", 10, kStart);
  heartbeats.begin("b", 10, kStart);
  EXPECT_THAT(heartbeats.overdue(kStart + 9 * kSecond), IsEmpty()) << "it may take long to begin";
  heartbeats.on_status("a", true, kStart);
  heartbeats.on_status("b", true, kStart);
  heartbeats.on_status("b", true, kStart + 3 * kSecond);
  EXPECT_THAT(heartbeats.overdue(kStart + 2 * kSecond), IsEmpty());
  EXPECT_THAT(heartbeats.overdue(kStart + 4 * kSecond), ElementsAre(std::pair<std::string, double>("a", 4)));
  heartbeats.on_status("a", true, kStart + 5 * kSecond);
  EXPECT_THAT(heartbeats.overdue(kStart + 5 * kSecond), IsEmpty());
}

TEST(Heartbeats, StrangersAndTheUnwatchedAreIgnored) {
  Heartbeats heartbeats;
  heartbeats.begin("a", 0, kStart);
  heartbeats.on_status("b", true, kStart);
  EXPECT_THAT(look(heartbeats, kStart, kStart + 100 * kSecond), IsEmpty());
}

}  // namespace
}  // namespace curbstone::procman::deputy
