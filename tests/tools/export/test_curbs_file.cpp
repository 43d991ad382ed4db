#include <algorithm>
#include <cmath>

#include "tests/tools/export/exported_map.hpp"

namespace curbstone::map_export {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A high curb far out with its high side on the left, a low one, a dropped one that is inferred; and what is of no
/// use.
std::vector<semantic_map::tile::CurbLine> some_curbs() {
  return {{0, 0.9F, false, {{-812.3456F, 431.1111F, -3.25F, 0.12F, 0, 1}, {-811.2F, 431.1F, -3.2F, 0.14F, 0, 1}}},
          {4, 0.5F, false, {{1, 2, 0, 0.03F, 1, 0}, {1, 3, 0.01F, 0.03F, 1, 0}, {1.0625F, 4, 0.02F, 0.04F, 1, 0}}},
          {5, 0.5F, true, {{5, 2, 0, 0.09F, -1, 0}, {5, 3, 0, 0.02F, -1, 0}}, true},
          {6, 0.5F, false, {{7, 2, 0, 0.09F, -1, 0}}},
          {7, 0.5F, false, {{7, 2, 0, 0.09F, -1, 0}, {1e30F, 2, 0, 0.09F, -1, 0}}}};
}

class CurbsFile : public ExportedMap {
 protected:
  void SetUp() override {
    ExportedMap::SetUp();
    if (!has_gdal()) GTEST_SKIP() << "no GDAL programs here";
    write_map({}, some_curbs());  // curbs alone are worth a file
  }
  static std::vector<semantic_map::tile::CurbVertex> usable_vertices() {
    std::vector<semantic_map::tile::CurbVertex> vertices;
    for (std::size_t i = 0; i < 3; ++i) {
      const semantic_map::tile::CurbLine line = some_curbs()[i];
      vertices.insert(vertices.end(), line.points.begin(), line.points.end());
    }
    return vertices;
  }
  /// What stands between the two words, wherever they stand in the text.
  static std::vector<std::string> between(const std::string& text, const std::string& begin, const std::string& end) {
    std::vector<std::string> found;
    for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
      at += begin.size();
      found.push_back(text.substr(at, text.find(end, at) - at));
    }
    return found;
  }
  /// The vertices of LINESTRING texts, one a row.
  static std::string vertices_of(const std::string& wkt, const std::string& begin) {
    std::string rows;
    for (std::string line : between(wkt, begin, ")")) {
      std::replace(line.begin(), line.end(), ',', '\n');
      rows += line + "\n";
    }
    return rows;
  }
};

TEST_F(CurbsFile, GeoJsonComesBackToTheMillimetreByWayOfProj) {
  ASSERT_EQ(run({"--only", "curbs", "--datum", "-33.8568,151.2153,25.5,90"}), 0);
  const std::string csv = output_of("ogr2ogr -f CSV /vsistdout/ " + out("curbs.geojson") + " -lco GEOMETRY=AS_WKT");
  const auto local = rows_of(output_of(
      "gdaltransform -ct '+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad +step +proj=cart +ellps=WGS84 "
      "+step +proj=topocentric +ellps=WGS84 +lat_0=-33.8568 +lon_0=151.2153 +h_0=25.5'",
      vertices_of(csv, "LINESTRING Z (")));
  const auto expected = usable_vertices();
  ASSERT_EQ(local.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(local[i][0], double{expected[i].x}, 2e-4);
    EXPECT_NEAR(local[i][1], double{expected[i].y}, 2e-4);
    EXPECT_NEAR(local[i][2], double{expected[i].z}, 2e-4);
  }
  EXPECT_THAT(csv, HasSubstr(R"(,"0",high,0.14,left,"0","0",0.9)"));
  EXPECT_THAT(csv, HasSubstr(R"(,"4",low,0.03,right,"0","0",0.5)"));
  EXPECT_THAT(csv, HasSubstr(R"(,"5",low,0.09,left,"1","1",0.5)"));
}

TEST_F(CurbsFile, Lanelet2HasTheCurbsAsGdalReadsThem) {
  ASSERT_EQ(run({"--only", "curbs", "--datum", "49.011,8.416,110,70"}), 0);
  const std::string osm = output_of("ogr2ogr -f CSV /vsistdout/ " + out("curbs.osm") + " points");
  // Local coordinates, in the order of the points.
  const auto x = between(osm, R"(""local_x""=>"")", R"("")");
  const auto y = between(osm, R"(""local_y""=>"")", R"("")");
  const auto expected = usable_vertices();
  ASSERT_EQ(x.size(), expected.size()) << osm;
  ASSERT_EQ(y.size(), expected.size()) << osm;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(std::stod(x[i]), double{expected[i].x}, 1e-4);
    EXPECT_NEAR(std::stod(y[i]), double{expected[i].y}, 1e-4);
  }
  // GDAL passes over heights; the Earth falls off by d^2 / 2 R: 6.6 cm in 920 m.
  EXPECT_THAT(text_of(out("curbs.osm")), HasSubstr(R"(<tag k="ele" v="106.816)"));
  const std::string lines = output_of("ogr2ogr -f CSV /vsistdout/ " + out("curbs.osm") + " lines");
  EXPECT_THAT(
      lines,
      HasSubstr(R"(""type""=>""curbstone"",""subtype""=>""high"",""height""=>""0.140"",""high_side""=>""left"")"));
  EXPECT_THAT(lines, HasSubstr(R"(""subtype""=>""low"",""height""=>""0.030"",""high_side""=>""right"")"));
  EXPECT_THAT(lines, HasSubstr(R"(""dropped""=>""yes"",""inferred""=>""yes"")"));
  // Where they are, by the nodes' latitude and longitude (GDAL keeps 1e-7 deg: a centimetre) of the line near the
  // datum.
  const auto wkt =
      output_of("ogr2ogr -f CSV /vsistdout/ " + out("curbs.osm") + " lines -lco GEOMETRY=AS_WKT -where \"osm_id='2'\"");
  const auto vertices = rows_of(vertices_of(wkt, "LINESTRING ("));
  ASSERT_EQ(vertices.size(), 3U) << wkt;
  const double a = 70 * M_PI / 180;  // (1, 2) in map
  EXPECT_NEAR((vertices[0][1] - 49.011) * 111'209, std::cos(a) + 2 * std::sin(a), 0.02);
  EXPECT_NEAR((vertices[0][0] - 8.416) * 73'151, std::sin(a) - 2 * std::cos(a), 0.02);
}

/// Lanelet2 takes a node without them for one at latitude 0, longitude 0, and says nothing.
TEST_F(CurbsFile, SaysThatTheNodesHaveNoLatitude) {
  ASSERT_EQ(run({"--only", "curbs"}), 0);
  EXPECT_THAT(said_, HasSubstr("no lat, lon in the .osm files"));
  ASSERT_EQ(run({"--only", "curbs", "--datum", "49,8"}), 0);
  EXPECT_THAT(said_, ::testing::Not(HasSubstr("no lat, lon")));
}

TEST_F(CurbsFile, WithoutADatumThereAreLocalCoordinatesOnly) {
  ASSERT_EQ(run({"--only", "curbs"}), 0);
  const std::string osm = text_of(out("curbs.osm"));
  EXPECT_THAT(osm, Not(HasSubstr("lat=")));
  EXPECT_THAT(osm, HasSubstr(R"(<tag k="local_y" v="431.1111"/>)"));
  EXPECT_THAT(osm, HasSubstr(R"(<tag k="ele" v="-3.2500"/>)"));
  EXPECT_FALSE(std::filesystem::exists(out("curbs.geojson")));
  EXPECT_THAT(said_, HasSubstr("2 curb lines left out"));
}

TEST_F(CurbsFile, SaysWhetherOneStepsUpOrDownFromTheDrivenPath) {
  semantic_map::tile::TrajectoryPose pose;
  pose.utime = 1;
  pose.T_map_base.translation() = Eigen::Vector3d(3, 3, 0);  // between curb 4 (high side +x) and 5 (high side -x)
  write_map({}, some_curbs(), {pose});
  ASSERT_EQ(run({"--only", "curbs", "--datum", "49,8"}), 0);
  const std::string json = text_of(out("curbs.geojson"));
  EXPECT_THAT(json, HasSubstr(R"("id":4,"properties":{"id":4,"subtype":"low","height":0.030,"high_side":"right",)"
                              R"("dropped":false,"inferred":false,"confidence":0.50,"rise":"down"})"));
  EXPECT_THAT(json, HasSubstr(R"("dropped":true,"inferred":true)"));
  EXPECT_THAT(text_of(out("curbs.osm")), HasSubstr(R"(<tag k="rise" v="down"/>)"));
}

TEST_F(CurbsFile, WhatIsHighIsForTheVehicleToSay) {
  ASSERT_EQ(run({"--only", "curbs", "--high-curb", "0.02"}), 0);
  const std::string osm = text_of(out("curbs.osm"));
  EXPECT_THAT(osm, HasSubstr(R"(<tag k="subtype" v="low"/>
    <tag k="height" v="0.090"/>)"));  // dropped ones stay low
  EXPECT_THAT(osm, HasSubstr(R"(<tag k="subtype" v="high"/>
    <tag k="height" v="0.030"/>)"));
}

}  // namespace
}  // namespace curbstone::map_export
