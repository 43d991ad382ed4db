#include "tools/export/marking_export.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace curbstone::map_export {
namespace {

using semantic_map::tile::MarkingLine;
using semantic_map::tile::MarkingType;
using ::testing::HasSubstr;
using ::testing::Not;

MarkingLine dashes() {
  return {.id = 4,
          .type = MarkingType::kDashed,
          .confidence = 0.9F,
          .width = 0.12F,
          .dash = 3,
          .gap = 6,
          .points = {{0, 0, 1, true}, {3, 0, 1, false}, {9, 0, 1, true}, {12, 0, 1, false}}};
}

MarkingLine crossing() {
  return {.id = 5,
          .type = MarkingType::kCrossing,
          .width = 4,
          .dash = 0.5F,
          .gap = 0.5F,
          .points = {{0, 0, 1, true}, {0, 0.5F, 1, false}, {0, 1, 1, true}, {0, 1.5F, 1, false}}};
}

TEST(MarkingExport, LaneletsKnowDashedLinesAndStopLines) {
  const std::string osm = markings_osm(
      {dashes(), {.type = MarkingType::kStopLine, .width = 0.4F, .points = {{5, -3, 0, true}, {5, 0, 0, false}}}},
      std::nullopt);
  EXPECT_THAT(osm, HasSubstr(R"(<tag k="type" v="line_thin"/>)"));
  EXPECT_THAT(osm, HasSubstr(R"(<tag k="subtype" v="dashed"/>)"));
  EXPECT_THAT(osm, HasSubstr(R"(<tag k="dash" v="3.000"/>)"));
  EXPECT_THAT(osm, HasSubstr(R"(<tag k="type" v="stop_line"/>)"));
  EXPECT_THAT(osm, Not(HasSubstr("lat=")));
}

TEST(MarkingExport, ACrossingHasTwoEdgesAcrossItsBars) {
  const std::string osm = markings_osm({crossing()}, std::nullopt);
  EXPECT_THAT(osm, HasSubstr(R"(<tag k="type" v="pedestrian_marking"/>)"));
  EXPECT_THAT(osm, HasSubstr(R"(<tag k="local_x" v="2.0000"/>)"));
  EXPECT_THAT(osm, HasSubstr(R"(<tag k="local_x" v="-2.0000"/>)"));
}

TEST(MarkingExport, GeoJsonHasTypeWidthAndWhereThePaintIs) {
  const auto json = nlohmann::json::parse(markings_geojson({dashes()}, geo::TangentPlane({49, 8, 100, 90})));
  const auto& properties = json["features"][0]["properties"];
  EXPECT_EQ(properties["type"], "dashed");
  EXPECT_NEAR(properties["width"].get<double>(), 0.12, 1e-6);
  EXPECT_EQ(properties["dashes"], nlohmann::json::parse("[[0.0,3.0],[9.0,12.0]]"));
  EXPECT_EQ(json["features"][0]["geometry"]["coordinates"].size(), 4U);
}

TEST(MarkingExport, SinglePointsAndWhatIsOutOfReachAreOfNoUse) {
  MarkingLine point{.points = {{1, 1, 1, true}}};
  MarkingLine far{.points = {{1, 1, 1, true}, {std::numeric_limits<float>::infinity(), 1, 1, false}}};
  EXPECT_EQ(usable_markings({point, far, dashes()}), std::vector<MarkingLine>{dashes()});
}

}  // namespace
}  // namespace curbstone::map_export
