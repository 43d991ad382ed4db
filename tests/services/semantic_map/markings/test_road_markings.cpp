#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "services/semantic_map/map_lines.hpp"
#include "services/semantic_map/marking_lines/clip_lines.hpp"
#include "services/semantic_map/marking_lines/marking_lines.hpp"
#include "services/semantic_map/nearby_markings.hpp"
#include "services/semantic_map/pipeline/tile_pipeline.hpp"
#include "tests/services/semantic_map/markings/painted_road.hpp"

namespace curbstone::semantic_map {
namespace {

using tile::MarkingLine;
using tile::MarkingType;

TEST(RoadMarkings, ASolidLineIsFoundWhereItIs) {
  const auto lines = lines_of(road([](double, double y) { return std::abs(y - 0.37) < 0.06 ? kPaint : kRoad; }));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].type, MarkingType::kSolid);
  EXPECT_NEAR(painted_length(lines[0]), 30, 0.5);
  EXPECT_NEAR(lines[0].width, 0.12, 0.07);  // it lies half in one cell, half in the next
  EXPECT_EQ(lines[0].dash, 0);
  EXPECT_GT(lines[0].confidence, 0.9);
  for (const tile::MarkingVertex& v : lines[0].points) EXPECT_NEAR(v.y, 0.37, 0.03) << v.x;
}

TEST(RoadMarkings, DashesAreOneLineWithTheirLengthsAndGaps) {
  const auto lines = lines_of(road([](double x, double y) {
    const double in_period = std::fmod(x + 150, 9.0);
    return std::abs(y) < 0.06 && in_period < 3 ? kPaint : kRoad;
  }));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].type, MarkingType::kDashed);
  EXPECT_NEAR(lines[0].dash, 3, 0.15);
  EXPECT_NEAR(lines[0].gap, 6, 0.15);
  EXPECT_FALSE(lines[0].points.back().painted);
}

TEST(RoadMarkings, ALineOfWhichALongPartIsHiddenIsStillSolid) {
  const auto lines = lines_of(road([](double x, double y) {
    return std::abs(y) < 0.06 && ((x > -12 && x < -6) || (x > 1 && x < 3.8)) ? kPaint : kRoad;
  }));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].type, MarkingType::kSolid) << "no dash is as long as its first part, and unlike the next";
}

TEST(RoadMarkings, AStopLineLiesAcrossTheWay) {
  const auto lines =
      lines_of(road([](double x, double y) { return std::abs(x - 2) < 0.2 && y > -4 && y < -0.5 ? kPaint : kRoad; }));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].type, MarkingType::kStopLine);
  EXPECT_NEAR(lines[0].width, 0.4, 0.1);
  EXPECT_NEAR(painted_length(lines[0]), 3.5, 0.2);
}

TEST(RoadMarkings, BarsSideBySideAreACrossing) {
  const auto lines = lines_of(road([](double x, double y) {
    return std::abs(x) < 2 && std::abs(y) < 3.5 && std::fmod(y + 10, 1.0) < 0.5 ? kPaint : kRoad;
  }));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].type, MarkingType::kCrossing);
  EXPECT_NEAR(lines[0].width, 4, 0.3);
  EXPECT_NEAR(lines[0].dash, 0.5, 0.12);
  EXPECT_NEAR(lines[0].gap, 0.5, 0.12);
}

TEST(RoadMarkings, ARoadWithoutPaintHasNone) {
  EXPECT_TRUE(lines_of(road([](double, double) { return kRoad; })).empty());
}

TEST(RoadMarkings, JointsTarPatchesAndPavementAreNoPaint) {
  EXPECT_TRUE(lines_of(road([](double, double y) { return std::abs(y) < 0.05 ? 5.0 : kRoad; })).empty());
  EXPECT_TRUE(lines_of(road([](double, double y) { return y > 1 ? 95.0 : kRoad; })).empty());
  EXPECT_TRUE(lines_of(road([](double x, double y) { return x > 0 && x < 4 && y > 0 ? 85.0 : kRoad; })).empty());
}

TEST(RoadMarkings, ABrightSlabOfPavementBesideTheRoadIsNoPaint) {
  for (const double slab : {1.3, 1.55, 1.8})
    EXPECT_TRUE(lines_of(road([&](double x, double y) {
                  if (y < 1) return kRoad;
                  return std::abs(y - slab) < 0.15 && std::abs(x) < 1.5 ? 150.0 : 130.0;
                })).empty())
        << slab;
}

TEST(RoadMarkings, TheStoneOfALoweredKerbIsNoPaint) {
  pipeline::TilePipeline pipeline({}, {});
  for (const tile::VotedTile& tile : road([](double, double y) { return std::abs(y - 2.1) < 0.1 ? kPaint : kRoad; }))
    pipeline.set_voted(tile);
  pipeline.settle();
  ASSERT_FALSE(all_markings(pipeline, {}, path(), {}).empty());
  tile::CurbLine kerb;
  kerb.dropped = true;
  for (int i = -75; i <= 75; ++i) kerb.points.push_back({0.2F * static_cast<float>(i), 2.0F, 0, 0.02F, 0, 1});
  EXPECT_TRUE(all_markings(pipeline, {kerb}, path(), {}).empty());
  for (tile::CurbVertex& v : kerb.points) v.y = 2.5F;  // an edge line before the kerb is one
  EXPECT_FALSE(all_markings(pipeline, {kerb}, path(), {}).empty());
}

TEST(RoadMarkings, BeyondALoweredKerbOnlyWhatIsLongerThanABrightStripOfALawnIsPaint) {
  const auto count = [](double length, bool is_lowered) {
    pipeline::TilePipeline pipeline({}, {});
    for (const tile::VotedTile& tile :
         road([&](double x, double y) { return std::abs(y - 4) < 0.1 && std::abs(x) < length / 2 ? kPaint : kRoad; }))
      pipeline.set_voted(tile);
    pipeline.settle();
    tile::CurbLine kerb;
    kerb.dropped = is_lowered;
    for (int i = -75; i <= 75; ++i) kerb.points.push_back({0.2F * static_cast<float>(i), 2.5F, 0, 0.02F, 0, 1});
    EXPECT_EQ(all_markings(pipeline, {}, path(), {}).size(), 1U) << length;
    EXPECT_EQ(all_markings(pipeline, {kerb}, {}, {}).size(), 1U) << "nobody drove: who knows on which side the road is";
    return all_markings(pipeline, {kerb}, path(), {}).size();
  };
  EXPECT_EQ(count(3, true), 0U);
  EXPECT_EQ(count(8, true), 1U) << "a road may go on there";
  EXPECT_EQ(count(8, false), 0U);
}

TEST(RoadMarkings, ALineEndsAtACrossing) {
  const auto lines = lines_of(road([](double x, double y) {
    const bool is_bar = std::abs(x) < 2 && std::abs(y) < 3.5 && std::fmod(y + 10, 1.0) < 0.5;
    return is_bar || (std::abs(y - 0.25) < 0.06 && std::abs(x) > 3.5 && std::abs(x) < 8.6) ? kPaint : kRoad;
  }));
  ASSERT_EQ(lines.size(), 3U) << "two lines of 5.1 m, and not one of two dashes";
  EXPECT_EQ(std::count_if(lines.begin(), lines.end(), [](const auto& l) { return l.type == MarkingType::kSolid; }), 2);
}

TEST(RoadMarkings, AnEdgeLineDoesNotBendIntoABarOfACrossing) {
  const auto lines = lines_of(road([](double x, double y) {
    const bool is_bar =
        std::abs(x) < 2 && y > -3 && y < 1.56 && std::fmod(y + 10, 1.0) > 0.06 && std::fmod(y + 10, 1.0) < 0.56;
    return is_bar || (std::abs(y - 1.2) < 0.06 && x < -2.6) ? kPaint : kRoad;
  }));
  ASSERT_EQ(lines.size(), 2U);
  for (const MarkingLine& line : lines) {
    if (line.type == MarkingType::kCrossing)
      EXPECT_EQ(line.points.size(), 10U) << "all of its bars";
    else
      EXPECT_NEAR(painted_length(line), 12.4, 1.0);
  }
}

TEST(RoadMarkings, WhereNoIntensityIsKnownThereIsNone) {
  auto tiles = road([](double, double y) { return std::abs(y) < 0.06 ? kPaint : kRoad; });
  for (tile::VotedTile& tile : tiles) tile.intensity.pop_back();  // of not all points: nobody knows which
  EXPECT_TRUE(lines_of(tiles).empty());
  for (tile::VotedTile& tile : tiles) tile.intensity.assign(tile.points.size(), 0);
  EXPECT_TRUE(lines_of(tiles).empty());
  for (tile::VotedTile& tile : tiles) tile.intensity.assign(tile.points.size(), 255);  // a saturated sensor
  EXPECT_TRUE(lines_of(tiles).empty());
}

TEST(RoadMarkings, DoNotDependOnTheOrderOfTilesNorOnWhoLooksWhen) {
  const auto tiles = road([](double x, double y) { return std::abs(y - 0.1 * x) < 0.06 ? kPaint : kRoad; });
  pipeline::TilePipeline backward({}, {});
  for (auto it = tiles.rbegin(); it != tiles.rend(); ++it) {
    backward.set_voted(*it);
    backward.run({pipeline::TileWork::Kind::kUpdate, it->key});
    for (int i = 0; i < 5; ++i) backward.run({pipeline::TileWork::Kind::kOldestStep});
  }
  while (backward.num_stale() > 0) backward.run({pipeline::TileWork::Kind::kOldestStep});
  EXPECT_EQ(all_markings(backward, all_curbs(backward), path(), {}), lines_of(tiles));
  EXPECT_FALSE(lines_of(tiles).empty());
}

TEST(RoadMarkings, AreTheSameOfACopyOfTheirSources) {
  const auto tiles = road([](double x, double y) { return std::abs(y - 0.1 * x) < 0.06 ? kPaint : kRoad; });
  pipeline::TilePipeline pipeline({}, {});
  for (const tile::VotedTile& tile : tiles) pipeline.set_voted(tile);
  pipeline.settle();
  const MapLineSources sources = line_sources(pipeline, path(), {});
  const tile::MapLines then{all_curbs(pipeline), all_markings(pipeline, all_curbs(pipeline), path(), {})};
  ASSERT_FALSE(then.markings.empty());
  pipeline.clear();
  const tile::MapLines lines = link(sources);
  EXPECT_EQ(lines.curbs, then.curbs);
  EXPECT_EQ(lines.markings, then.markings);
}

TEST(RoadMarkings, AreLookedForOnlyWhereThatIsAskedFor) {
  const auto tiles = road([](double, double y) { return std::abs(y) < 0.06 ? kPaint : kRoad; });
  markings::MarkingParameters off;
  off.enabled = false;
  pipeline::TilePipeline pipeline({}, {}, off);
  for (const tile::VotedTile& tile : tiles) pipeline.set_voted(tile);
  pipeline.settle();
  EXPECT_EQ(pipeline.num_stale(), 0U);
  EXPECT_TRUE(all_markings(pipeline, {}, path(), off).empty());
}

/// m, from a place to the nearest of those lines that `counts`.
double distance_to(const std::vector<MarkingLine>& lines, const Eigen::Vector2d& at,
                   const std::function<bool(const MarkingLine&)>& counts) {
  double nearest = 1e9;
  for (const MarkingLine& line : lines) {
    if (!counts(line)) continue;
    for (std::size_t i = 1; i < line.points.size(); ++i) {
      const Eigen::Vector2d a(double{line.points[i - 1].x}, double{line.points[i - 1].y});
      const Eigen::Vector2d way = Eigen::Vector2d(double{line.points[i].x}, double{line.points[i].y}) - a;
      const double share = std::clamp((at - a).dot(way) / way.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (a + share * way - at).norm());
    }
  }
  return nearest;
}

/// A dashed line along x, beside it a slanting solid one, and a crossing at x = 7: what a box's edge can cut.
double crossing_and_lines(double x, double y) {
  if (std::abs(x - 7) < 1.5) return std::abs(y) < 4 && std::fmod(y + 8, 1.0) < 0.5 ? kPaint : kRoad;
  if (std::abs(y + 0.3) < 0.06 && std::fmod(x + 15, 3) < 1.2) return kPaint;
  return std::abs(y - 3 - 0.1 * x) < 0.06 ? kPaint : kRoad;
}

TEST(RoadMarkings, AtTheEdgeOfItsBoxAMessageSaysWhatTheMapSays) {
  pipeline::TilePipeline pipeline({}, {});
  for (const tile::VotedTile& tile : road(crossing_and_lines)) pipeline.set_voted(tile);
  pipeline.settle();
  const auto map = all_markings(pipeline, {}, path(), {});
  int all = 0, of_other_type = 0;
  for (double x = -6; x <= 6; x += 0.5) {
    const auto message = NearbyMarkings(4, {}).next(pipeline, {}, {x, 0.0}, path());
    for (const marking_line_t& line : message.lines) {
      const auto same_type = [&](const MarkingLine& other) {
        return static_cast<std::int8_t>(other.type) == line.type;
      };
      for (std::size_t i = 0; i < line.x.size(); ++i) {
        const Eigen::Vector2d at(double{line.x[i]}, double{line.y[i]});
        EXPECT_LE((at - Eigen::Vector2d(x, 0)).lpNorm<Eigen::Infinity>(), 4.001);
        EXPECT_LT(distance_to(map, at, [](const MarkingLine&) { return true; }), 0.08) << x << ": " << at.transpose();
        of_other_type += distance_to(map, at, same_type) > 0.08 ? 1 : 0;
        ++all;
      }
    }
  }
  EXPECT_GT(all, 500);
  EXPECT_LT(of_other_type, all / 50) << "of " << all << ": a line that hardly begins in what is looked at";
}

TEST(CutLines, EndOnTheBoxsEdgeAndKeepTheirGaps) {
  MarkingLine line;
  line.type = MarkingType::kDashed;
  line.width = 0.12F;
  for (int i = 0; i <= 10; ++i)
    line.points.push_back({static_cast<float>(i), 1, 0.1F * static_cast<float>(i), i % 2 == 0});
  const auto parts = marking_lines::clip_lines({line}, {2.5, 0.0}, {6.25, 5.0});
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].type, MarkingType::kDashed);
  const std::vector<tile::MarkingVertex> expected = {{2.5F, 1, 0.25F, true}, {3, 1, 0.3F, false},
                                                     {4, 1, 0.4F, true},     {5, 1, 0.5F, false},
                                                     {6, 1, 0.6F, true},     {6.25F, 1, 0.625F, false}};
  ASSERT_EQ(parts[0].points.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_FLOAT_EQ(parts[0].points[i].x, expected[i].x);
    EXPECT_FLOAT_EQ(parts[0].points[i].z, expected[i].z);
    EXPECT_EQ(parts[0].points[i].painted, expected[i].painted) << i;
  }
}

TEST(CutLines, OfALineThatLeavesAndComesBackAreTwoAndOfOneBesideTheBoxNone) {
  MarkingLine line;
  for (const auto& [x, y] : {std::pair{0.F, 0.F}, {4.F, 0.F}, {4.F, 2.F}, {0.F, 2.F}})
    line.points.push_back({x, y, 0, true});
  EXPECT_EQ(marking_lines::clip_lines({line}, {-1.0, -1.0}, {3.0, 3.0}).size(), 2U);
  EXPECT_EQ(marking_lines::clip_lines({line}, {-9.0, -9.0}, {9.0, 9.0}), std::vector<MarkingLine>{[&] {
              MarkingLine whole = line;
              whole.points.back().painted = false;
              return whole;
            }()});
  EXPECT_TRUE(marking_lines::clip_lines({line}, {-9.0, 0.5}, {3.0, 1.5}).empty());
  EXPECT_TRUE(marking_lines::clip_lines({MarkingLine{}}, {-9.0, -9.0}, {9.0, 9.0}).empty());
}

TEST(MarkingLineIds, StayWithTheLineWhileItGrows) {
  const auto line = [](float y, int n) {
    MarkingLine made;
    for (int i = 0; i < n; ++i) made.points.push_back({0.2F * static_cast<float>(i), y, 0, true});
    return made;
  };
  marking_lines::MarkingLineIds ids;
  std::vector<MarkingLine> first = {line(0, 20), line(3, 20)};
  ids.assign(first);
  EXPECT_NE(first[0].id, first[1].id);
  std::vector<MarkingLine> second = {line(6, 20), line(3, 40), line(0, 40)};
  ids.assign(second);
  EXPECT_EQ(second[1].id, first[1].id);
  EXPECT_EQ(second[2].id, first[0].id);
  EXPECT_NE(second[0].id, first[0].id);
  EXPECT_NE(second[0].id, first[1].id);
}

/// A curb along x at y = 3 m, its higher side beyond.
tile::CurbLine curb_between(double from, double to) {
  tile::CurbLine line;
  line.confidence = 0.9F;
  for (int i = 0; i <= static_cast<int>(std::lround((to - from) / 0.2)); ++i)
    line.points.push_back({static_cast<float>(from + 0.2 * i), 3, 0, 0.12F, 0, 1});
  std::reverse(line.points.begin(), line.points.end());  // the high side on the right
  return line;
}

TEST(RoadMarkings, StonesThatLieFlushBetweenTwoCurbsAreNoPaint) {
  const auto stones = [](double x, double y) { return std::abs(x) < 2 && y > 3 && y < 3.15 ? 130 : kRoad; };
  pipeline::TilePipeline pipeline({}, {});
  for (const tile::VotedTile& tile : road(stones)) pipeline.set_voted(tile);
  pipeline.settle();
  EXPECT_EQ(all_markings(pipeline, {}, path(), {}).size(), 1U) << "nothing tells that it is stone";
  EXPECT_EQ(all_markings(pipeline, {curb_between(-8, -2.2)}, path(), {}).size(), 1U) << "nor does one curb";
  EXPECT_EQ(all_markings(pipeline, {curb_between(-8, -6), curb_between(6, 8)}, path(), {}).size(), 1U) << "too far";
  EXPECT_TRUE(all_markings(pipeline, {curb_between(-8, -2.2), curb_between(2.2, 8)}, path(), {}).empty());
}

TEST(RoadMarkings, AnEdgeLineDoesNotBendIntoAStopLine) {
  const auto lines = lines_of(road([](double x, double y) {
    const bool is_edge = std::abs(y - 2.0) < 0.06 && x < 5.15;
    const bool is_stop = std::abs(x - 5.0) < 0.15 && y > -2.5 && y < 2.06;
    return is_edge || is_stop ? kPaint : kRoad;
  }));
  ASSERT_EQ(lines.size(), 2U);
  for (const MarkingLine& line : lines) {
    const bool is_stop = line.type == MarkingType::kStopLine;
    EXPECT_EQ(line.type, is_stop ? MarkingType::kStopLine : MarkingType::kSolid);
    EXPECT_NEAR(painted_length(line), is_stop ? 4.5 : 20, 0.6);
    for (const tile::MarkingVertex& v : line.points) {
      if (is_stop)
        EXPECT_NEAR(v.x, 5, 0.1) << v.y;
      else
        EXPECT_NEAR(v.y, 2, 0.1) << v.x;
    }
  }
  EXPECT_NE(lines[0].type, lines[1].type);
}

TEST(RoadMarkings, LinesOfNoPointsAndOfPointsAtOnePlaceAreNone) {
  EXPECT_TRUE(marking_lines::link_marking_cells({}, {}, {}).empty());
  const std::vector<marking_lines::MapMarkingCell> heap(50, {{1, 1}, 0, 80, true});
  EXPECT_TRUE(marking_lines::link_marking_cells(heap, {}, {}).empty());
}

}  // namespace
}  // namespace curbstone::semantic_map
