#include "services/semantic_map/marking_lines/line_types.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace curbstone::semantic_map::marking_lines {
namespace {

using testing::ElementsAre;
using tile::MarkingType;

/// Pieces of paint along x, from and to, m.
PieceSequence along_x(const std::vector<std::pair<double, double>>& painted) {
  PieceSequence sequence;
  for (const auto& [from, to] : painted) {
    MarkingPiece& piece = sequence.emplace_back();
    piece.begin_at = {from, 0};
    piece.end_at = {to, 0};
    piece.end = to - from;
    piece.begin_direction = -Eigen::Vector2d::UnitX();
    piece.end_direction = Eigen::Vector2d::UnitX();
    piece.width = 0.12;
    piece.contrast = 60;
    for (const double share : {0.0, 0.5, 1.0})
      piece.samples.push_back({share * piece.end, {from + share * piece.end, 0, 0, 60}, 1});
  }
  return sequence;
}

/// Type and number of pieces of each part. `hidden`: from and to, m along x, where no ground was seen.
std::vector<std::pair<MarkingType, std::size_t>> types_of(const std::vector<std::pair<double, double>>& painted,
                                                          const std::vector<std::pair<double, double>>& hidden = {}) {
  const auto is_seen = [&](const Eigen::Vector2d& at) {
    for (const auto& [from, to] : hidden) {
      if (at.x() > from && at.x() < to) return false;
    }
    return true;
  };
  std::vector<std::pair<MarkingType, std::size_t>> types;
  for (const TypedSequence& part : type_sequence(along_x(painted), {}, is_seen))
    types.emplace_back(part.type, part.pieces.size());
  return types;
}

constexpr auto kIsSolid = MarkingType::kSolid;
constexpr auto kIsDashed = MarkingType::kDashed;

TEST(LineTypes, AGapThatNobodySawIsNotOneOfDashes) {
  // An edge line behind a parked car.
  EXPECT_THAT(types_of({{0, 3.4}, {9.1, 14}}, {{3.4, 9.1}}), ElementsAre(std::pair(kIsSolid, 2)));
  EXPECT_THAT(types_of({{0, 3.4}, {9.1, 14}}), ElementsAre(std::pair(kIsDashed, 2)));
}

TEST(LineTypes, ADashThatIsHiddenDoesNotMakeALineSolid) {
  EXPECT_THAT(types_of({{0, 3}, {9, 12}, {18, 21}}, {{3, 9}}), ElementsAre(std::pair(kIsDashed, 3)));
}

TEST(LineTypes, DashesBeforeASolidLineAreALineOfTheirOwn) {
  EXPECT_THAT(types_of({{0, 20}, {26, 29}, {35, 38}}), ElementsAre(std::pair(kIsSolid, 1), std::pair(kIsDashed, 2)));
  EXPECT_THAT(types_of({{0, 3}, {9, 12}, {18, 38}}), ElementsAre(std::pair(kIsDashed, 2), std::pair(kIsSolid, 1)));
}

TEST(LineTypes, ASingleDashBetweenSolidLinesHasAGapOnEachSide) {
  EXPECT_THAT(types_of({{0, 11}, {17, 20}, {26, 48}}),
              ElementsAre(std::pair(kIsSolid, 1), std::pair(kIsDashed, 1), std::pair(kIsSolid, 1)));
}

TEST(LineTypes, WhatAWornHolePartsFromASolidLineIsSolid) {
  EXPECT_THAT(types_of({{0, 20}, {21, 23.5}, {24.4, 40}}), ElementsAre(std::pair(kIsSolid, 3)));
  EXPECT_THAT(types_of({{0, 3.5}, {4.2, 20}}), ElementsAre(std::pair(kIsSolid, 2)));
}

TEST(LineTypes, WhatACarPartsFromASolidLineIsSolid) {
  EXPECT_THAT(types_of({{0, 20}, {25, 27}, {30, 45}}, {{20, 25}, {27, 30}}), ElementsAre(std::pair(kIsSolid, 3)));
}

TEST(LineTypes, AWornSolidLineBeforeDashesIsPartedFromThem) {
  EXPECT_THAT(types_of({{0, 5.1}, {6.1, 10.9}, {13.7, 16.4}, {23, 25.5}, {31.5, 34.2}}),
              ElementsAre(std::pair(kIsSolid, 2), std::pair(kIsDashed, 3)));
}

TEST(LineTypes, AWornHoleInADashIsNoGap) {
  EXPECT_THAT(types_of({{0, 1.3}, {1.7, 3}, {9, 12}, {18, 19.2}, {19.7, 21}}), ElementsAre(std::pair(kIsDashed, 5)));
}

TEST(LineTypes, WithoutKnowingWhatWasSeenAllOfItWas) {
  EXPECT_EQ(type_sequence(along_x({{0, 3}, {9, 12}}), {}, nullptr).front().type, kIsDashed);
}

}  // namespace
}  // namespace curbstone::semantic_map::marking_lines
