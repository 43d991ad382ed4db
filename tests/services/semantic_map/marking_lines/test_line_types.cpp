#include "services/semantic_map/marking_lines/line_types.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
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
    for (double s = 0; s <= piece.end; s += 0.1) piece.samples.push_back({s, {from + s, 0, 0, 60}, 1});
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
  EXPECT_THAT(types_of({{0, 20}, {24, 27}, {33, 36}}), ElementsAre(std::pair(kIsSolid, 1), std::pair(kIsDashed, 2)));
  EXPECT_THAT(types_of({{0, 3}, {9, 12}, {16, 36}}), ElementsAre(std::pair(kIsDashed, 2), std::pair(kIsSolid, 1)));
}

TEST(LineTypes, ASingleDashBetweenSolidLinesHasAGapOnEachSide) {
  EXPECT_THAT(types_of({{0, 11}, {17, 20}, {24, 48}}),
              ElementsAre(std::pair(kIsSolid, 1), std::pair(kIsDashed, 1), std::pair(kIsSolid, 1)));
}

TEST(LineTypes, ASingleDashBetweenSolidLinesIsADashWhereTheLaterOneBeginsInTheGap) {
  EXPECT_THAT(types_of({{0, 11}, {17, 20}, {22.3, 48}}),
              ElementsAre(std::pair(kIsSolid, 1), std::pair(kIsDashed, 1), std::pair(kIsSolid, 1)));
}

TEST(LineTypes, ASingleDashBehindASolidLineIsNoneOfIt) {
  EXPECT_THAT(types_of({{0, 14.3}, {20.5, 23.7}}), ElementsAre(std::pair(kIsSolid, 1), std::pair(kIsDashed, 1)));
  EXPECT_THAT(types_of({{0, 3.2}, {9.4, 23.7}}), ElementsAre(std::pair(kIsDashed, 1), std::pair(kIsSolid, 1)));
  EXPECT_THAT(types_of({{0, 14.3}, {20.5, 23.7}}, {{14.3, 20.5}}), ElementsAre(std::pair(kIsSolid, 2)));
}

TEST(LineTypes, ASingleDashMayBeWornInTwo) {
  EXPECT_THAT(types_of({{0, 14.3}, {20.3, 21.5}, {22, 23.4}}),
              ElementsAre(std::pair(kIsSolid, 1), std::pair(kIsDashed, 2)));
}

TEST(LineTypes, ALineThatIsPaintedButForAFifthIsSolid) {
  EXPECT_THAT(types_of({{0, 3.8}, {4.6, 6.7}, {7.8, 9.8}}), ElementsAre(std::pair(kIsSolid, 3)));
}

TEST(LineTypes, APieceBetweenWornHolesIsNoDash) {
  EXPECT_THAT(types_of({{0, 9}, {9.8, 10.9}, {11.6, 20}}), ElementsAre(std::pair(kIsSolid, 3)));
  EXPECT_THAT(types_of({{0, 9}, {10.7, 12.1}, {14.2, 25}}), ElementsAre(std::pair(kIsSolid, 3)));
  EXPECT_THAT(types_of({{0, 12}, {14, 16}}), ElementsAre(std::pair(kIsSolid, 2)));
  EXPECT_THAT(types_of({{0, 4}, {5, 5.9}, {7, 7.9}, {9.1, 12.8}, {13.9, 21.1}}).front().first, kIsSolid);
}

/// From and to, m along x, of each part.
std::vector<std::pair<int, int>> parts_of(const std::vector<std::pair<double, double>>& painted) {
  std::vector<std::pair<int, int>> parts;
  for (const TypedSequence& part : type_sequence(along_x(painted), {}, nullptr))
    parts.emplace_back(static_cast<int>(std::lround(part.pieces.front().begin_at.x())),
                       static_cast<int>(std::lround(part.pieces.back().end_at.x())));
  return parts;
}

TEST(LineTypes, ADashThatAbutsOnASolidLineIsOneOfTheDashes) {
  // As far from the next dash as the dashes are apart.
  EXPECT_THAT(types_of({{0, 23}, {29, 32}, {38, 41}}), ElementsAre(std::pair(kIsSolid, 1), std::pair(kIsDashed, 3)));
  EXPECT_THAT(parts_of({{0, 23}, {29, 32}, {38, 41}}), ElementsAre(std::pair(0, 20), std::pair(20, 41)));
  EXPECT_THAT(parts_of({{0, 3}, {9, 12}, {18, 41}}), ElementsAre(std::pair(0, 21), std::pair(21, 41)));
  EXPECT_THAT(parts_of({{0, 23}, {29, 32}, {38, 41}, {45, 60}}),
              ElementsAre(std::pair(0, 20), std::pair(20, 41), std::pair(45, 60)));
}

TEST(LineTypes, AnAbuttingDashThatIsWornThroughIsOneOfTheDashes) {
  EXPECT_THAT(parts_of({{0, 20}, {20.5, 23}, {29, 32}, {38, 41}}), ElementsAre(std::pair(0, 20), std::pair(21, 41)));
  EXPECT_THAT(parts_of({{0, 22}, {22.5, 23}, {29, 32}, {38, 41}}), ElementsAre(std::pair(0, 20), std::pair(20, 41)));
}

TEST(LineTypes, DashesThatGoOverIntoAWornLineAreALineOfTheirOwn) {
  // As in a worn town: no piece of the solid line is longer than a dash may be.
  EXPECT_THAT(
      types_of(
          {{0, 2.8}, {9.5, 12.1}, {18.4, 21.1}, {27.1, 29}, {35.9, 38.5}, {40.2, 46.4}, {47.3, 47.9}, {48.7, 49.8}}),
      ElementsAre(std::pair(kIsDashed, 5), std::pair(kIsSolid, 3)));
}

TEST(LineTypes, HolesOfAMetreBesideASolidLineHaveNoRhythm) {
  EXPECT_THAT(types_of({{0, 20}, {21, 22}, {23, 24}, {25, 26}}), ElementsAre(std::pair(kIsSolid, 4)));
  EXPECT_THAT(types_of({{21, 22}, {23, 24}, {25, 26}}), ElementsAre(std::pair(kIsDashed, 3))) << "beside none";
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
