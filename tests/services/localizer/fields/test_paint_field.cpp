#include "services/localizer/fields/paint_field.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace curbstone::localizer::fields {
namespace {

using semantic_map::tile::MarkingLine;

/// Dashes of 3 m, 0.12 m wide, along x at y = 1: from 0, 9, 18 m and so on.
MarkingLine dashes(int count) {
  MarkingLine line;
  line.width = 0.12F;
  for (int i = 0; i < count; ++i) {
    const auto x = static_cast<float>(9 * i);
    line.points.push_back({x, 1, 0, true});
    line.points.push_back({x + 3, 1, 0, false});
  }
  return line;
}

TEST(PaintField, TellsNothingOnThePaintAndTheOffsetBesideIt) {
  const PaintField field({dashes(3)});
  EXPECT_TRUE(field.offset_at(1.5, 1.05)->isZero());
  EXPECT_TRUE(field.offset_at(1.5, 1.26)->isApprox(Eigen::Vector2d(0, 0.2), 1e-5));
  EXPECT_TRUE(field.offset_at(3.3, 1.0)->isApprox(Eigen::Vector2d(0.4, 0), 1e-5)) << "beyond the end of a dash";
  EXPECT_TRUE(field.offset_at(8.6, 0.84)->isApprox(Eigen::Vector2d(-0.5, -0.1), 1e-5))
      << "before the next, and beside it";
}

TEST(PaintField, KnowsNothingOfGapsNorFarFromPaint) {
  const PaintField field({dashes(3)});
  EXPECT_FALSE(field.offset_at(6, 1)) << "in the middle of a gap";
  EXPECT_FALSE(field.offset_at(1.5, 1.7));
  EXPECT_FALSE(field.offset_at(-40, 1));
  EXPECT_FALSE(PaintField().offset_at(0, 0));
  EXPECT_TRUE(PaintField().empty());
}

TEST(PaintField, ReachesAcrossTheEdgesOfTiles) {
  MarkingLine line;
  line.width = 0.2F;
  line.points = {{-1, 2.95F, 0, true}, {7, 2.95F, 0, false}};  // tiles end at 3 m
  const PaintField field({line});
  for (double x = -1; x < 7; x += 0.3) EXPECT_NEAR(field.offset_at(x, 3.45)->y(), 0.4, 1e-6) << x;
}

TEST(PaintField, ALineOfUnknownWidthIsOfTheUsualOne) {
  MarkingLine line;
  line.points = {{0, 0, 0, true}, {3, 0, 0, false}};
  EXPECT_NEAR(PaintField({line}).offset_at(1, 0.16)->y(), 0.1, 1e-6);
}

TEST(PaintField, DrawsInTheEndsOfADashOnlyNotThoseOfItsPieces) {
  MarkingLine line;
  for (int i = 0; i <= 6; ++i) line.points.push_back({0.5F * static_cast<float>(i), 0, 0, i < 6});
  const PaintField field({line});
  for (double x = 0.1; x < 2.9; x += 0.05) EXPECT_TRUE(field.offset_at(x, 0)->isZero(1e-5)) << x;
  EXPECT_NEAR(field.offset_at(0, 0)->x(), -0.1, 1e-5);
  EXPECT_NEAR(field.offset_at(3, 0)->x(), 0.1, 1e-5);
}

TEST(PaintField, LeavesOutWhatIsDamaged) {
  MarkingLine line;
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  line.points = {{0, 0, 0, true}, {kNaN, 0, 0, true}, {1e30F, 0, 0, true}, {5, 5, 0, true}, {5, 5, 0, true}};
  EXPECT_TRUE(PaintField({line}).empty());
  line.points = {{0, 0, 0, true}, {3, 0, 0, false}};
  line.width = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(PaintField({line}).empty());
}

}  // namespace
}  // namespace curbstone::localizer::fields
