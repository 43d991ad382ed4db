#include "services/mapper/place_recognition/visibility_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace curbstone::mapper::place_recognition {
namespace {

using Cloud = std::vector<Eigen::Vector3f>;

/// A wall ahead, square to x, from -45 to 45 degrees.
Cloud wall(float x) {
  Cloud out;
  for (float y = -x; y <= x; y += 0.02F) {
    for (float z = -2; z <= 2; z += 0.2F) out.push_back({x, y, z});
  }
  return out;
}

TEST(VisibilityCheck, AgreesWithWhatItSaw) {
  const VisibilityCount count = VisibilityCheck(wall(10)).check(wall(10.2F));
  EXPECT_GT(count.agree, 1000);
  EXPECT_EQ(count.conflict, 0);
}

TEST(VisibilityCheck, ConflictsWithWhatItLookedThrough) {
  const VisibilityCount count = VisibilityCheck(wall(10)).check(wall(6));
  EXPECT_GT(count.conflict, 1000);
  EXPECT_EQ(count.agree, 0);
}

TEST(VisibilityCheck, SaysNothingOfWhatIsHiddenOrBesideOrOutOfReach) {
  const VisibilityCheck sight(wall(10));
  for (const Cloud& unseen : {wall(14), Cloud{{-5, 0, 0}, {0, 5, 0}}, Cloud{{1, 0, 9}}, Cloud{{NAN, 0, 0}}}) {
    const VisibilityCount count = sight.check(unseen);
    EXPECT_EQ(count.agree + count.conflict, 0);
  }
  const VisibilityCount far = VisibilityCheck(wall(50)).check(wall(40));
  EXPECT_EQ(far.conflict, 0) << "rays are far apart there";
  EXPECT_EQ(VisibilityCheck({}).check(wall(5)).conflict, 0);
}

}  // namespace
}  // namespace curbstone::mapper::place_recognition
