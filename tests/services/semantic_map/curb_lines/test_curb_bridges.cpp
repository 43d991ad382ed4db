#include "services/semantic_map/curb_lines/curb_bridges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace curbstone::semantic_map::curb_lines {
namespace {

/// A curb along y = 0 from x = `from` to `to`; the pavement lies at y < 0, on its right.
tile::CurbLine curb(double from, double to, float height = 0.12F, double y = 0) {
  tile::CurbLine line;
  line.confidence = 0.8F;
  const int pieces = static_cast<int>(std::lround((to - from) / 0.2));
  for (int k = 0; k <= pieces; ++k) {
    const double x = from + (to - from) * k / pieces;
    line.points.push_back({static_cast<float>(x), static_cast<float>(y), 0, height, 0, -1});
  }
  return line;
}

std::optional<double> hidden(const Eigen::Vector2d&) {
  return std::nullopt;
}

std::vector<tile::CurbLine> bridges_of(std::vector<tile::CurbLine> lines, const SeenGround& ground = hidden) {
  const std::size_t measured = lines.size();
  add_bridges(ground, lines);
  lines.erase(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(measured));
  return lines;
}

TEST(CurbBridges, ACurbGoesOnBehindAParkedCar) {
  std::vector<tile::CurbLine> lines = {curb(0, 5), curb(10, 15)};
  add_bridges(hidden, lines);
  ASSERT_EQ(lines.size(), 3U);
  const tile::CurbLine& bridge = lines[2];
  EXPECT_TRUE(bridge.inferred);
  EXPECT_FALSE(bridge.dropped);
  EXPECT_EQ(bridge.id, 2);
  EXPECT_LT(bridge.confidence, lines[0].confidence);
  EXPECT_EQ(bridge.points.front().x, 5.0F);
  EXPECT_EQ(bridge.points.back().x, 10.0F);
  for (const tile::CurbVertex& v : bridge.points) {
    EXPECT_NEAR(v.y, 0, 1e-3);
    EXPECT_NEAR(v.height, 0.12, 1e-3);
    EXPECT_NEAR(v.high_side_y, -1, 1e-3);
  }
  EXPECT_FALSE(lines[0].inferred);
  EXPECT_FALSE(lines[1].inferred);
}

TEST(CurbBridges, ItFollowsABend) {
  constexpr double kRadius = 25;
  const auto arc = [](double from, double to) {
    tile::CurbLine line;
    line.confidence = 0.8F;
    for (double s = from; s < to + 1e-9; s += 0.2) {
      const double a = s / kRadius;
      line.points.push_back({static_cast<float>(kRadius * std::sin(a)),
                             static_cast<float>(kRadius - kRadius * std::cos(a)), 0, 0.12F,
                             static_cast<float>(std::sin(a)), static_cast<float>(-std::cos(a))});
    }
    return line;
  };
  const auto found = bridges_of({arc(0, 5), arc(10, 15)});
  ASSERT_EQ(found.size(), 1U);
  for (const tile::CurbVertex& v : found[0].points)
    EXPECT_NEAR(std::hypot(double{v.x}, kRadius - double{v.y}), kRadius, 0.06);
}

TEST(CurbBridges, GroundThatIsSeenWithoutAStepSaysThereIsNone) {
  std::vector<tile::CurbLine> lines = {curb(0, 5), curb(10, 15)};
  EXPECT_TRUE(bridges_of(lines, [](const Eigen::Vector2d&) { return std::optional(0.0); }).empty());
  // A step that the test for one does not find for lack of points is no objection,
  EXPECT_EQ(bridges_of(lines, [](const Eigen::Vector2d& at) { return std::optional(at.y() < 0 ? 0.11 : 0.0); }).size(),
            1U);
  // nor is a road that is seen on one side only,
  const auto road_only = [](const Eigen::Vector2d& at) { return at.y() > 0 ? std::optional(0.0) : std::nullopt; };
  EXPECT_EQ(bridges_of(lines, road_only).size(), 1U);
  // but a driveway that was seen between two parked cars is.
  const auto driveway = [](const Eigen::Vector2d& at) {
    return at.x() > 7 && at.x() < 8 ? std::optional(at.y() < 0 ? 0.02 : 0.0) : std::nullopt;
  };
  EXPECT_TRUE(bridges_of(lines, driveway).empty());
}

TEST(CurbBridges, OnlyWhereBothEndsPointAcross) {
  EXPECT_TRUE(bridges_of({curb(0, 5), curb(10, 15, 0.12F, 1.0)}).empty()) << "beside it";
  EXPECT_TRUE(bridges_of({curb(0, 5), curb(15, 20)}).empty()) << "too far";
  EXPECT_TRUE(bridges_of({curb(0, 5), curb(10, 15, 0.06F)}).empty()) << "as high";
  EXPECT_TRUE(bridges_of({curb(0, 5), curb(10, 10.8)}).empty()) << "too short to say";
  auto turned = curb(10, 15);
  for (tile::CurbVertex& v : turned.points) v.high_side_y = 1;
  std::reverse(turned.points.begin(), turned.points.end());
  EXPECT_TRUE(bridges_of({curb(0, 5), turned}).empty()) << "the other side is higher";
  auto lowered = curb(10, 15);
  lowered.dropped = true;
  EXPECT_TRUE(bridges_of({curb(0, 5), lowered}).empty()) << "a lowered kerb";
  auto falls = curb(0, 5);
  falls.points.back().height = 0.03F;
  EXPECT_TRUE(bridges_of({falls, curb(10, 15)}).empty()) << "it is being lowered where it ends";
}

/// Falls towards the curb by 2.5 %, a lip, a ramp of 8 %; and the noise of cells.
SeenGround driveway_with(double lip) {
  return [lip](const Eigen::Vector2d& at) {
    const double noise = 0.006 * std::sin(37 * at.x() + 91 * at.y());
    return std::optional(noise + (at.y() > 0 ? 0.025 * at.y() : lip - 0.08 * at.y()));
  };
}

TEST(CurbBridges, ALipOfTwoCentimetresBetweenTwoCurbsIsALoweredKerb) {
  const auto found = bridges_of({curb(0, 5), curb(9, 14)}, driveway_with(0.02));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].dropped);
  EXPECT_FALSE(found[0].inferred);
  ASSERT_GT(found[0].points.size(), 10U);
  EXPECT_NEAR(found[0].points[10].height, 0.02, 0.005);
}

TEST(CurbBridges, ADrivewayWithoutALipIsNone) {
  EXPECT_TRUE(bridges_of({curb(0, 5), curb(9, 14)}, driveway_with(0)).empty());
}

TEST(CurbBridges, AMeasuredLineInBetweenIsBelieved) {
  EXPECT_TRUE(bridges_of({curb(0, 5), curb(10, 15), curb(7, 8, 0.12F, 0.3)}).empty());
}

TEST(CurbBridges, EachEndHasOnePartnerTheNearest) {
  const auto found = bridges_of({curb(0, 4), curb(6, 10), curb(11, 15)});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].points.front().x, 10.0F);
  EXPECT_EQ(found[1].points.front().x, 4.0F);
}

TEST(FlushKerbs, LieWhereTwoCurbsPointAtEachOther) {
  const auto found = flush_kerbs({curb(0, 5), curb(8, 14)});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].points.front().x, 5.0F);
  EXPECT_EQ(found[0].points.back().x, 8.0F);
  EXPECT_TRUE(flush_kerbs({curb(0, 5), curb(8, 8.8)}).empty()) << "too short to say";
}

TEST(FlushKerbs, AShortPieceBetweenTwoCurbsIsOneOfTheStones) {
  const auto found = flush_kerbs({curb(0, 5), curb(6, 6.6, 0.03F), curb(9, 14)});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].points.front().x, 5.0F);
  EXPECT_EQ(found[0].points.back().x, 9.0F);
  EXPECT_TRUE(flush_kerbs({curb(0, 5), curb(6, 8, 0.12F, 0.4), curb(9, 14)}).empty()) << "a curb of another course";
}

TEST(FlushKerbs, ACurbThatIsCutWhereItIsLoweredPointsOnLikeAWholeOne) {
  tile::CurbLine lowered = curb(8, 9, 0.03F);
  lowered.dropped = true;
  for (const auto& lines :
       {std::vector{curb(0, 5), lowered, curb(9, 14)}, std::vector{curb(9, 14), curb(0, 5), lowered}}) {
    const auto found = flush_kerbs(lines);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].points.front().x, 5.0F);
    EXPECT_EQ(found[0].points.back().x, 8.0F);
  }
  EXPECT_TRUE(flush_kerbs({curb(0, 5), lowered}).empty()) << "nothing else says where it points to";
}

}  // namespace
}  // namespace curbstone::semantic_map::curb_lines
