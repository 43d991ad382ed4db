#include "services/semantic_map/curb_lines/joints.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace curbstone::semantic_map::curb_lines {
namespace {

using Partners = std::vector<std::size_t>;

TEST(JointsTest, AnEndIsJoinedOnceAcrossTheShorterGap) {
  const Partners partner = join_shortest_first(3, {{2.0, last_end(0), first_end(1)}, {1.0, last_end(0), first_end(2)}});
  EXPECT_EQ(partner[last_end(0)], first_end(2));
  EXPECT_EQ(partner[first_end(2)], last_end(0));
  EXPECT_EQ(partner[first_end(1)], kFree);
}

TEST(JointsTest, ALineDoesNotCloseToARing) {
  const Partners partner = join_shortest_first(
      3, {{1.0, last_end(0), first_end(1)}, {2.0, last_end(1), first_end(2)}, {3.0, last_end(2), first_end(0)}});
  EXPECT_EQ(partner[last_end(1)], first_end(2));
  EXPECT_EQ(partner[last_end(2)], kFree);
  EXPECT_EQ(partner[first_end(0)], kFree);
}

TEST(JointsTest, APieceIsNotJoinedToItself) {
  const Partners partner = join_shortest_first(1, {{0.5, last_end(0), first_end(0)}});
  EXPECT_EQ(partner, Partners(2, kFree));
}

TEST(JointsTest, PiecesMayMeetWithLikeEnds) {
  const Partners partner = join_shortest_first(2, {{0.5, last_end(0), last_end(1)}});
  EXPECT_EQ(partner[last_end(1)], last_end(0));
  EXPECT_EQ(opposite(last_end(1)), first_end(1));
}

TEST(JointsTest, OfEqualGapsThatOfTheLowerEndsIsClosedWhateverTheOrder) {
  std::vector<Joint> joints = {{1.0, last_end(0), first_end(1)}, {1.0, last_end(0), first_end(2)}};
  const Partners partner = join_shortest_first(3, joints);
  EXPECT_EQ(partner[last_end(0)], first_end(1));
  std::reverse(joints.begin(), joints.end());
  EXPECT_EQ(join_shortest_first(3, joints), partner);
}

}  // namespace
}  // namespace curbstone::semantic_map::curb_lines
