#include "services/ekf/inputs/stamp_guard.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace curbstone::ekf::inputs {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using Verdict = StampGuard::Verdict;

constexpr std::int64_t kMaxJump = 1'000'000;  // us
constexpr std::int64_t kNow = 1'750'000'000'000'000;
constexpr std::int64_t kHour = 3'600'000'000;

class StampGuardTest : public ::testing::Test {
 protected:
  std::vector<Verdict> judge(const std::vector<std::int64_t>& stamps) {
    std::vector<Verdict> verdicts;
    for (const std::int64_t stamp : stamps) verdicts.push_back(guard_.judge(kNow + stamp));
    return verdicts;
  }
  StampGuard guard_{kMaxJump};
};

TEST_F(StampGuardTest, TheFirstStampIsGoodWhateverItIs) {
  EXPECT_THAT(judge({-kNow}), ElementsAre(Verdict::kGood));
}

TEST_F(StampGuardTest, StampsMayGrowByUpToTheLargestJump) {
  EXPECT_THAT(judge({0, 1, 10'000, 10'000 + kMaxJump}), Each(Verdict::kGood));
  EXPECT_THAT(judge({10'000 + 2 * kMaxJump + 1}), ElementsAre(Verdict::kSuspicious));
}

TEST_F(StampGuardTest, DuplicatesAndStampsFromBeforeAreNamedAndChangeNothing) {
  EXPECT_THAT(judge({0, 0, -10, -kMaxJump, 5, 0}),
              ElementsAre(Verdict::kGood, Verdict::kDuplicate, Verdict::kBackwards, Verdict::kBackwards, Verdict::kGood,
                          Verdict::kBackwards));
}

TEST_F(StampGuardTest, OneWildStampIsABadMessage) {
  EXPECT_THAT(judge({0, kHour, 10'000, -kHour, 20'000}),
              ElementsAre(Verdict::kGood, Verdict::kSuspicious, Verdict::kGood, Verdict::kSuspicious, Verdict::kGood));
}

TEST_F(StampGuardTest, ThreeWildStampsThatAgreeAreAClockThatHasJumped) {
  for (const std::int64_t jump : {kHour, -2 * kHour}) {
    guard_.reset();
    EXPECT_THAT(judge({0, jump, jump + 10'000, jump + 20'000, jump + 30'000, 0}),
                ElementsAre(Verdict::kGood, Verdict::kSuspicious, Verdict::kSuspicious, Verdict::kJumped,
                            Verdict::kGood, Verdict::kSuspicious));
  }
}

TEST_F(StampGuardTest, WildStampsThatDoNotAgreeAreNeverFollowed) {
  ASSERT_THAT(judge({0}), Each(Verdict::kGood));
  for (int i = 1; i < 50; ++i) EXPECT_THAT(judge({i * kHour, -i * kHour}), Each(Verdict::kSuspicious)) << i;
  EXPECT_THAT(judge({10'000}), Each(Verdict::kGood));
}

TEST_F(StampGuardTest, AStampThatDoesNotMoveOnIsNoClock) {
  ASSERT_THAT(judge({0}), Each(Verdict::kGood));
  EXPECT_THAT(judge(std::vector<std::int64_t>(20, kHour)), Each(Verdict::kSuspicious));
}

TEST_F(StampGuardTest, AGoodStampBetweenThemMakesWildOnesBeginAnew) {
  EXPECT_THAT(judge({0, kHour, kHour + 1, 10'000, kHour + 2, kHour + 3, kHour + 4}),
              ElementsAre(Verdict::kGood, Verdict::kSuspicious, Verdict::kSuspicious, Verdict::kGood,
                          Verdict::kSuspicious, Verdict::kSuspicious, Verdict::kJumped));
}

TEST_F(StampGuardTest, AfterAResetAnyStampIsTheFirst) {
  EXPECT_THAT(judge({0, kHour}), ElementsAre(Verdict::kGood, Verdict::kSuspicious));
  guard_.reset();
  EXPECT_THAT(judge({-kHour, -kHour + 10'000}), Each(Verdict::kGood));
}

}  // namespace
}  // namespace curbstone::ekf::inputs
