#include "services/semantic_map/marking_lines/crossings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace curbstone::semantic_map::marking_lines {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

MarkingPiece straight(const Eigen::Vector2d& begin, const Eigen::Vector2d& end, double width) {
  MarkingPiece piece;
  piece.begin_at = begin;
  piece.end_at = end;
  piece.end = (end - begin).norm();
  piece.end_direction = (end - begin).normalized();
  piece.begin_direction = -piece.end_direction;
  piece.width = width;
  piece.contrast = 60;
  for (const double share : {0.0, 0.5, 1.0}) {
    const Eigen::Vector2d at = begin + share * (end - begin);
    piece.samples.push_back({share * piece.end, {at.x(), at.y(), 0, 60}, 1});
  }
  return piece;
}

/// Bars of 4 m along x, a metre apart.
std::vector<MarkingPiece> bars(int count) {
  std::vector<MarkingPiece> pieces;
  for (int i = 0; i < count; ++i) pieces.push_back(straight({-2, 1.0 * i}, {2, 1.0 * i}, 0.5));
  return pieces;
}

std::vector<float> places_of(const tile::MarkingLine& crossing) {
  std::vector<float> places;
  for (std::size_t i = 0; i + 1 < crossing.points.size(); i += 2)
    places.push_back((crossing.points[i].y + crossing.points[i + 1].y) / 2);
  return places;
}

TEST(Crossings, AreBarsSideBySide) {
  auto pieces = bars(4);
  const auto crossings = extract_crossings(pieces);
  ASSERT_THAT(crossings, SizeIs(1));
  EXPECT_THAT(places_of(crossings[0]), ElementsAre(0, 1, 2, 3));
  EXPECT_FLOAT_EQ(crossings[0].width, 4);
  EXPECT_THAT(pieces, IsEmpty());
}

TEST(Crossings, AreNotTwoBars) {
  auto pieces = bars(2);
  EXPECT_THAT(extract_crossings(pieces), IsEmpty());
  EXPECT_THAT(pieces, SizeIs(2));
}

TEST(Crossings, GoOnBeyondABarThatIsWornAway) {
  std::vector<MarkingPiece> pieces;
  for (const double y : {0.0, 1.0, 3.0, 4.0}) pieces.push_back(straight({-2, y}, {2, y}, 0.5));  // pairs
  pieces.push_back(straight({-2, 6}, {2, 6}, 0.5));
  pieces.push_back(straight({-2, 8}, {2, 8}, 0.5));  // singles, each beyond a missed one
  const auto crossings = extract_crossings(pieces);
  ASSERT_THAT(crossings, SizeIs(1));
  EXPECT_THAT(places_of(crossings[0]), ElementsAre(0, 1, 3, 4, 6, 8));
  EXPECT_FLOAT_EQ(crossings[0].gap, 0.5F) << "the gap between bars, not the place of a missed one";
  EXPECT_THAT(pieces, IsEmpty());
}

TEST(Crossings, HaveAPaceOfAllTheirBars) {
  std::vector<MarkingPiece> pieces;  // as measured in a worn town: one bar is 0.1 m off
  for (const double y : {-4.89, -3.91, -2.04, -0.89, 0.95}) pieces.push_back(straight({-2, y}, {2, y}, 0.4));
  const auto crossings = extract_crossings(pieces);
  ASSERT_THAT(crossings, SizeIs(1));
  EXPECT_THAT(places_of(crossings[0]), SizeIs(5));
}

TEST(Crossings, DoNotGoOnBeyondTwoMissedBars) {
  auto pieces = bars(3);
  for (const double y : {5.0, 6.0, 7.0}) pieces.push_back(straight({-2, y}, {2, y}, 0.5));
  EXPECT_THAT(extract_crossings(pieces), SizeIs(2));
}

TEST(Crossings, AreNotDashesSideBySideAsFarAsALane) {
  std::vector<MarkingPiece> pieces;
  for (const double y : {0.0, 2.75, 5.5}) pieces.push_back(straight({-2, y}, {2, y}, 0.3));
  EXPECT_THAT(extract_crossings(pieces), IsEmpty());
}

TEST(Crossings, OfTwoWholeBarsHavePartsOfOthersBesideThem) {
  auto pieces = bars(2);
  pieces.push_back(straight({0.8, 2}, {1.7, 2}, 0.4));
  const auto crossings = extract_crossings(pieces);
  ASSERT_THAT(crossings, SizeIs(1));
  EXPECT_THAT(places_of(crossings[0]), ElementsAre(0, 1, 2));
  EXPECT_THAT(pieces, IsEmpty());
}

TEST(Crossings, HaveTheBarsOfWhichOnlyAPartIsSeen) {
  auto pieces = bars(3);
  pieces.push_back(straight({0.8, 3}, {2, 3}, 0.5));    // the next one
  pieces.push_back(straight({-2, -1}, {-1, -1}, 0.5));  // and one on the other side, in two parts
  pieces.push_back(straight({0.2, -1}, {1.5, -1}, 0.5));
  const auto crossings = extract_crossings(pieces);
  ASSERT_THAT(crossings, SizeIs(1));
  EXPECT_THAT(places_of(crossings[0]), ElementsAre(-1, 0, 1, 2, 3));
  for (const tile::MarkingVertex& v : crossings[0].points) EXPECT_NEAR(v.x, 0, 1e-6) << "in the middle of the way";
  EXPECT_FLOAT_EQ(crossings[0].width, 4);
  EXPECT_THAT(pieces, IsEmpty());
}

TEST(Crossings, AreAsWideAsTheBarsThatAreWhole) {
  auto pieces = bars(3);
  for (const double y : {3.0, 4.0, 5.0, 6.0}) pieces.push_back(straight({1, y}, {2, y}, 0.5));
  const auto crossings = extract_crossings(pieces);
  ASSERT_THAT(crossings, SizeIs(1));
  EXPECT_THAT(places_of(crossings[0]), SizeIs(7));
  EXPECT_FLOAT_EQ(crossings[0].width, 4);
}

/// The same with a sample each decimetre.
MarkingPiece sampled(const Eigen::Vector2d& begin, const Eigen::Vector2d& end, double width) {
  MarkingPiece piece = straight(begin, end, width);
  piece.samples.clear();
  for (double s = 0; s <= piece.end; s += 0.1) {
    const Eigen::Vector2d at = begin + s * piece.end_direction;
    piece.samples.push_back({s, {at.x(), at.y(), 0, 60}, 1});
  }
  return piece;
}

TEST(Crossings, TakeTheBarOutOfTheLineThatItWasLinkedTo) {
  for (const auto& [from, to] : {std::pair{-20.0, 2.1}, std::pair{2.1, -20.0}}) {
    std::vector<MarkingPiece> pieces;  // as in a worn town: the edge line led into the bar beside its end
    for (const double y : {0.0, 1.0, 2.0, 4.0}) pieces.push_back(straight({-2, y}, {2, y}, 0.4));
    pieces.push_back(sampled({from, 3}, {to, 3}, 0.17));
    const auto crossings = extract_crossings(pieces);
    ASSERT_THAT(crossings, SizeIs(1));
    EXPECT_THAT(places_of(crossings[0]), ElementsAre(0, 1, 2, 3, 4));
    ASSERT_THAT(pieces, SizeIs(1));
    EXPECT_NEAR(pieces[0].length(), 18, 0.01);
    EXPECT_NEAR(pieces[0].width, 0.17, 1e-6);
  }
}

TEST(Crossings, LeaveTheLinesThatRunBesideThemWhole) {
  for (const double y : {3.0, 3.5}) {  // at the pace of their bars, but not between two
    auto pieces = bars(3);
    pieces.push_back(sampled({-20, y}, {2.1, y}, 0.17));
    EXPECT_THAT(extract_crossings(pieces), SizeIs(1));
    ASSERT_THAT(pieces, SizeIs(1));
    EXPECT_NEAR(pieces[0].length(), 22.1, 0.01);
  }
}

TEST(Crossings, HaveNothingAcrossTheirBars) {
  auto pieces = bars(5);
  pieces.push_back(straight({-1.5, 0.8}, {-1.5, 2.2}, 0.25));
  EXPECT_THAT(extract_crossings(pieces), SizeIs(1));
  EXPECT_THAT(pieces, IsEmpty());
}

TEST(Crossings, LeaveTheStopLineBeforeThemAndTheLinesThatEndThere) {
  auto pieces = bars(5);
  pieces.push_back(straight({-3, 0}, {-3, 4}, 0.4));
  pieces.push_back(straight({1.9, 2}, {12, 2}, 0.15));
  pieces.push_back(straight({-2, 5.9}, {2, 5.9}, 0.15));  // an edge line as long as they are: too narrow for a bar
  EXPECT_THAT(extract_crossings(pieces), SizeIs(1));
  EXPECT_THAT(pieces, SizeIs(3));
}

}  // namespace
}  // namespace curbstone::semantic_map::marking_lines
