#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>

#include "services/semantic_map/marking_lines/marking_pieces.hpp"
#include "tests/services/semantic_map/markings/painted_road.hpp"

namespace curbstone::semantic_map {
namespace {

using tile::MarkingType;

TEST(MarkingPieces, AStoneBetweenRoadAndPavementIsNoPaint) {
  for (const double pavement : {120.0, 132.0, 150.0})
    EXPECT_TRUE(lines_of(road([&](double x, double y) {
                  if (y < 2 || std::abs(x) > 2.5) return kRoad;  // as where a driveway's kerb is lowered
                  return y < 2.14 ? 197.0 : pavement;
                })).empty())
        << pavement;
}

TEST(MarkingPieces, ThePatchBesideATarredSeamIsNoPaint) {
  for (const double patch : {80.0, 90.0, 100.0})
    EXPECT_TRUE(lines_of(road([&](double x, double y) {
                  const double outside = std::max(std::abs(x) - 4, std::abs(y) - 1);
                  return std::abs(outside) < 0.03 ? 5.0 : outside < 0 ? patch : kRoad;
                })).empty())
        << patch;
}

TEST(MarkingPieces, WornPaintOnTheEdgeOfAPatchIsPaint) {
  const auto lines = lines_of(road([](double, double y) {
    if (std::abs(y - 0.37) < 0.06) return kRoad + 60;
    return y > 0.43 ? kRoad + 10 : kRoad;
  }));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].type, MarkingType::kSolid);
  EXPECT_NEAR(painted_length(lines[0]), 30, 1);
}

TEST(MarkingPieces, AStripOfAPatchBetweenTwoSeamsIsNoPaint) {
  for (const double patch : {88.0, 92.0, 96.0})
    EXPECT_TRUE(lines_of(road([&](double x, double y) {
                  if (std::abs(x) > 4 || std::abs(y) > 0.43) return kRoad;
                  return std::abs(y) < 0.03 || std::abs(y) > 0.37 ? 5.0 : patch;
                })).empty())
        << patch;
}

TEST(MarkingPieces, AWornDoubleLineIsPaint) {
  const auto lines =
      lines_of(road([](double, double y) { return std::abs(std::abs(y - 0.3) - 0.14) < 0.06 ? kRoad + 50 : kRoad; }));
  ASSERT_FALSE(lines.empty());
  for (const auto& line : lines) EXPECT_EQ(line.type, MarkingType::kSolid);
  EXPECT_GT(painted_length(lines[0]), 28);
}

TEST(MarkingPieces, WhatIsBroadAlongASeamMustBeBrighter) {
  marking_lines::MarkingPiece piece;
  piece.width = 0.5;
  piece.contrast = 30;
  EXPECT_TRUE(marking_lines::is_paint(piece, {}));
  piece.tar = 0.15;
  EXPECT_FALSE(marking_lines::is_paint(piece, {}));
  piece.contrast = 50;
  EXPECT_TRUE(marking_lines::is_paint(piece, {}));
  piece.contrast = 30;
  piece.width = 0.15;
  EXPECT_TRUE(marking_lines::is_paint(piece, {})) << "a line along the seam of the road's middle";
}

TEST(MarkingPieces, AStripThatIsBroaderThanAnyMarkingMustBeBrighterStill) {
  marking_lines::MarkingPiece piece;
  piece.width = 0.45;  // as it looks against the ground around, which is the strip in part
  piece.contrast = 35;
  piece.full_width = 0.5;
  EXPECT_TRUE(marking_lines::is_paint(piece, {}));
  piece.full_width = 0.7;
  EXPECT_FALSE(marking_lines::is_paint(piece, {}));
  piece.contrast = 60;
  EXPECT_TRUE(marking_lines::is_paint(piece, {}));
}

TEST(MarkingPieces, APieceIsPaintIfBothItsSidesAreDarker) {
  marking_lines::MarkingPiece piece;
  piece.width = 0.12;
  piece.contrast = 100;
  piece.left = 5;
  piece.right = -20;
  EXPECT_TRUE(marking_lines::is_paint(piece, {}));
  for (auto side : {&marking_lines::MarkingPiece::left, &marking_lines::MarkingPiece::right}) {
    marking_lines::MarkingPiece edge = piece;
    edge.*side = 60;
    EXPECT_FALSE(marking_lines::is_paint(edge, {}));
    edge.*side = std::nullopt;
    EXPECT_TRUE(marking_lines::is_paint(edge, {})) << "nobody sees that side";
  }
}

TEST(MarkingPieces, ABroadPieceIsPaintOnlyIfItIsBrighterThanAFaintLine) {
  marking_lines::MarkingPiece piece;
  piece.contrast = 23;
  piece.left = piece.right = 0;
  for (const double width : {0.05, 0.12, 0.3}) {
    piece.width = width;
    EXPECT_TRUE(marking_lines::is_paint(piece, {})) << width;
  }
  for (const double width : {0.5, 0.7}) {
    piece.width = width;
    EXPECT_FALSE(marking_lines::is_paint(piece, {})) << width;
  }
  piece.contrast = 40;
  EXPECT_TRUE(marking_lines::is_paint(piece, {}));
}

TEST(MarkingPieces, ALineLongerThanADashIsSolidAndSoIsOneWithHoles) {
  const auto type = [](const std::function<bool(double)>& is_painted) {
    const auto lines =
        lines_of(road([&](double x, double y) { return std::abs(y) < 0.06 && is_painted(x) ? kPaint : kRoad; }));
    return lines.size() == 1 ? lines[0].type : MarkingType::kOther;
  };
  EXPECT_EQ(type([](double x) { return std::abs(x) < 2.5; }), MarkingType::kSolid);
  EXPECT_EQ(type([](double x) { return std::abs(x) < 1.5; }), MarkingType::kUnknown) << "it may be a dash";
  EXPECT_EQ(type([](double x) { return std::abs(x) < 12 && std::fmod(x + 12, 5.0) > 1.4; }), MarkingType::kSolid);
  EXPECT_EQ(type([](double x) { return std::abs(x) < 12 && std::fmod(x + 12, 5.0) > 2.0; }), MarkingType::kDashed);
}

}  // namespace
}  // namespace curbstone::semantic_map
