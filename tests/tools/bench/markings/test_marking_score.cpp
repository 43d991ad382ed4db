#include "tools/bench/markings/marking_score.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/paths.hpp"
#include "tools/bench/markings/painted_street.hpp"
#include "tools/detect/cloud_map/cloud_map.hpp"

namespace curbstone::bench::markings {
namespace {

using semantic_map::tile::MarkingLine;
using semantic_map::tile::MarkingType;

MarkingLine along_x(float from, float to, float y, MarkingType type) {
  MarkingLine line;
  line.type = type;
  line.width = 0.12F;
  line.points = {{from, y, 0, true}, {to, y, 0, false}};
  return line;
}

bool everywhere(const Eigen::Vector2d&) {
  return true;
}

TEST(MarkingScore, TellsWhatIsRightFromWhatIsMissingAndWhatIsFalse) {
  const std::vector<TrueLine> truth = {{MarkingType::kSolid, {{{{0, 0}, {20, 0}}, 0.12}}}};
  const std::vector<MarkingLine> lines = {along_x(0, 10, 0.05F, MarkingType::kSolid),
                                          along_x(0, 5, 3.05F, MarkingType::kDashed)};
  const LineScore score = score_lines(lines, Pose::Identity(), truth, everywhere);
  EXPECT_NEAR(score.right_metres, 10, 0.01);
  EXPECT_NEAR(score.false_metres, 5, 0.01);
  EXPECT_NEAR(score.type_share(), 1, 0.01);
  EXPECT_NEAR(score.cells.recall(), 0.5, 0.03);
  EXPECT_NEAR(score.cells.precision(), 2.0 / 3, 0.03);
  ASSERT_FALSE(score.lateral.empty());
  for (const double lateral : score.lateral) EXPECT_NEAR(lateral, 0.05, 1e-6);
}

TEST(MarkingScore, AWrongTypeAndAnUnknownOneAreNotRight) {
  const std::vector<TrueLine> truth = {{MarkingType::kDashed, {{{{0, 0}, {3, 0}}, 0.12}, {{{9, 0}, {12, 0}}, 0.12}}}};
  const std::vector<MarkingLine> lines = {along_x(0, 3, 0, MarkingType::kDashed),
                                          along_x(9, 12, 0, MarkingType::kUnknown)};
  EXPECT_NEAR(score_lines(lines, Pose::Identity(), truth, everywhere).type_share(), 0.5, 0.01);
}

TEST(MarkingScore, TheMiddleOfADoubleLineIsAsGoodAsEither) {
  const std::vector<TrueLine> truth = {
      {MarkingType::kSolid, {{{{0, 0.12}, {9, 0.12}}, 0.12}, {{{0, -0.12}, {9, -0.12}}, 0.12}}, {{0, 0}, {9, 0}}}};
  const LineScore score = score_lines({along_x(0, 9, 0.01F, MarkingType::kSolid)}, Pose::Identity(), truth, everywhere);
  for (const double lateral : score.lateral) EXPECT_NEAR(lateral, 0.01, 1e-6);
}

/// The floor of what 64 beams at rest in a recorded street give; `curbstone bench markings --parts street` says what
/// they are.
TEST(PaintedStreet, MarkingsOfARecordedStreetAreFound) {
  const std::string folder = test::data_path("kitti00");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const PaintTruth truth = read_street_paint(folder);
  EXPECT_GT(truth.painted.size(), 300U);
  const PaintedStreet street = read_painted_streets(folder).front();
  detect::cloud_map::CloudMapOptions options;
  options.range = 20;
  detect::cloud_map::CloudMap map;
  const auto tiles = detect::cloud_map::vote_tiles(street.points, options, map, street.by_ring);
  detect::cloud_map::map_tiles(tiles, options, map);
  const CellScore score = score_cells(cells_of(map.markings, Pose::Identity()), truth);
  EXPECT_GT(score.recall(), 0.85);
  EXPECT_GT(score.f1(), 0.75);
  EXPECT_TRUE(std::any_of(map.markings.begin(), map.markings.end(),
                          [](const MarkingLine& line) { return line.type == MarkingType::kDashed; }));
}

}  // namespace
}  // namespace curbstone::bench::markings
