#include "tools/simulate/paint/plan_markings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>

namespace curbstone::simulate::paint {
namespace {

double length_of(const MarkingPiece& piece) {
  double length = 0;
  for (std::size_t i = 1; i < piece.centre.size(); ++i) length += (piece.centre[i] - piece.centre[i - 1]).norm();
  return length;
}

class Markings : public testing::TestWithParam<world::TownOptions> {
 protected:
  Markings() : town_(GetParam()), markings_(plan_markings(town_, numerics::Random(GetParam().seed).fork(7))) {}
  world::Town town_;
  std::vector<Marking> markings_;
};
INSTANTIATE_TEST_SUITE_P(Towns, Markings,
                         testing::Values(world::TownOptions{.seed = 1}, world::TownOptions{.seed = 2},
                                         world::TownOptions{.seed = 3, .loop = 600},
                                         world::TownOptions{.seed = 4, .straight = 300}));

TEST_P(Markings, LieOnTheCarriageway) {
  const world::Ground& ground = town_.scene->ground();
  for (const Marking& marking : markings_) {
    for (const MarkingPiece& piece : marking.pieces) {
      ASSERT_GE(piece.centre.size(), 2U);
      EXPECT_GT(length_of(piece), 0.4);
      for (const Eigen::Vector2d& p : piece.centre) {
        ASSERT_TRUE(ground.inside(p.x(), p.y()));
        EXPECT_LT(ground.at(static_cast<float>(p.x()), static_cast<float>(p.y())).distance, -0.3F)
            << name_of(marking.type);
      }
    }
  }
}

TEST_P(Markings, AreOfSeveralTypesAndMostOfTheStreetHasSome) {
  std::map<MarkingType, double> lengths;
  for (const Marking& marking : markings_) {
    for (const MarkingPiece& piece : marking.pieces) lengths[marking.type] += length_of(piece);
  }
  const double street = town_.streets.front().length();
  EXPECT_GT(lengths[MarkingType::kSolid], 0.5 * street);
  EXPECT_GT(lengths[MarkingType::kDashed], 0.05 * street);
  EXPECT_GT(lengths[MarkingType::kCrossing], 20);
}

TEST_P(Markings, HaveDashesThatRepeat) {
  for (const Marking& marking : markings_) {
    if (marking.type != MarkingType::kDashed || marking.pieces.size() < 3) continue;
    const double dash = length_of(marking.pieces[0]);
    EXPECT_TRUE(std::abs(dash - 3) < 0.2 || std::abs(dash - 2) < 0.2) << dash;
    for (std::size_t i = 0; i + 1 < marking.pieces.size() - 1; ++i) {
      const double gap = (marking.pieces[i + 1].centre.front() - marking.pieces[i].centre.back()).norm();
      EXPECT_NEAR(gap, dash > 2.5 ? 6 : 3, 0.3);
    }
  }
}

TEST(MarkingsOfATown, AreTheSameOnEveryDay) {
  const world::Town one({.seed = 1}), other({.seed = 1, .day = 5});
  const auto a = plan_markings(one, numerics::Random(1)), b = plan_markings(other, numerics::Random(1));
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_EQ(a[i].pieces.back().centre.back(), b[i].pieces.back().centre.back());
}

}  // namespace
}  // namespace curbstone::simulate::paint
