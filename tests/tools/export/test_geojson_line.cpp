#include "tools/export/geo/geojson_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/export/geojson_file.hpp"
#include "tools/export/marking_export.hpp"

namespace curbstone::map_export {
namespace {

using nlohmann::json;
using Line = std::vector<Eigen::Vector3d>;

json geometry_of(const Line& in_map, const geo::GeoDatum& datum) {
  return json::parse(geo::geojson_line(in_map, geo::TangentPlane(datum)));
}

/// Each part within half a turn, and as many positions as were counted.
void expect_parts(const json& geometry, const std::vector<std::size_t>& sizes) {
  ASSERT_EQ(geometry["type"], "MultiLineString");
  ASSERT_EQ(geometry["coordinates"].size(), sizes.size()) << geometry;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const json& part = geometry["coordinates"][i];
    EXPECT_EQ(part.size(), sizes[i]) << geometry;
    for (const json& position : part)
      EXPECT_LT(std::abs(position[0].get<double>() - part[0][0].get<double>()), 180) << geometry;
  }
}

TEST(GeoJsonLine, IsCutAtThe180thMeridian) {
  const geo::GeoDatum fiji{-16.8, 180, 12, 90};
  const json geometry = geometry_of({{-30, 1, 0}, {-10, 1, 0}, {10, 3, 1}, {20, 3, 1}}, fiji);
  expect_parts(geometry, {3, 3});
  const json& end = geometry["coordinates"][0][2];
  const json& begin = geometry["coordinates"][1][0];
  EXPECT_EQ(end[0], 180);
  EXPECT_EQ(begin[0], -180);
  EXPECT_EQ(end[1], begin[1]);
  const double metre = 1 / 110'650.0;  // deg of latitude there
  EXPECT_NEAR(end[1].get<double>(), -16.8 + 2 * metre, 0.01 * metre) << "half way between y = 1 and y = 3";
  EXPECT_NEAR(end[2].get<double>(), 12.5, 1e-3);
  EXPECT_LT(geometry["coordinates"][0][1][0], 180);
  EXPECT_GT(geometry["coordinates"][0][1][0], 179.9);
  EXPECT_LT(geometry["coordinates"][1][1][0], -179.9);
}

TEST(GeoJsonLine, IsCutAtEachCrossing) {
  const geo::GeoDatum east_of_it{65, -179.9999, 0, 90};  // 4.7 m east
  expect_parts(geometry_of({{10, 0, 0}, {-10, 1, 0}, {-20, 1, 0}, {0, 2, 0}, {5, 3, 0}}, east_of_it), {2, 4, 3});
}

TEST(GeoJsonLine, AVertexOnTheMeridianIsInBothParts) {
  expect_parts(geometry_of({{-10, 0, 0}, {0, 0, 0}, {10, 0, 0}}, {0, 180, 0, 90}), {2, 2});
  EXPECT_EQ(geometry_of({{-10, 0, 0}, {0, 0, 0}}, {0, 180, 0, 90})["type"], "LineString");
  EXPECT_EQ(geometry_of({{10, 0, 0}, {0, 0, 0}}, {0, 180, 0, 90})["type"], "LineString");
  EXPECT_EQ(geometry_of({{0, 0, 0}, {10, 0, 0}}, {0, -180, 0, 90})["type"], "LineString");
}

TEST(GeoJsonLine, IsWholeElsewhere) {
  const Line line{{-10, 0, 0}, {10, 0, 0}, {-10, 1, 0}};
  for (const geo::GeoDatum datum :
       {geo::GeoDatum{51.5, 0, 0, 90}, geo::GeoDatum{-33.9, 151.2, 0, 90}, geo::GeoDatum{0, 179.99, 0, 90}}) {
    const json geometry = geometry_of(line, datum);
    EXPECT_EQ(geometry["type"], "LineString");
    EXPECT_EQ(geometry["coordinates"].size(), 3U);
  }
}

/// Round the pole each line that passes beyond it crosses the meridian, and those on this side do not.
TEST(GeoJsonLine, AtAPoleToo) {
  for (const double pole : {90.0, -90.0}) {
    const geo::GeoDatum datum{pole, 0, 2800, 90};  // y from 180 deg (at the south pole 0 deg) on
    const double far = pole > 0 ? 5 : -5;
    expect_parts(geometry_of({{-10, far, 0}, {10, far, 0}}, datum), {2, 2});
    EXPECT_EQ(geometry_of({{-10, -far, 0}, {10, -far, 0}}, datum)["type"], "LineString");
  }
}

TEST(GeoJsonLine, IsTheGeometryOfCurbsAndOfMarkings) {
  const geo::TangentPlane plane({-16.8, 180, 0, 90});
  const json curbs = json::parse(curbs_geojson(
      {{.id = 1, .confidence = 1, .dropped = false, .points = {{-1, 0, 0, 0.1F, 0, 1}, {1, 0, 0, 0.1F, 0, 1}}}}, {},
      plane));
  expect_parts(curbs["features"][0]["geometry"], {2, 2});
  const json markings = json::parse(markings_geojson(
      {{.type = semantic_map::tile::MarkingType::kSolid, .points = {{-1, 0, 0, true}, {1, 0, 0, false}}}}, plane));
  expect_parts(markings["features"][0]["geometry"], {2, 2});
}

}  // namespace
}  // namespace curbstone::map_export
