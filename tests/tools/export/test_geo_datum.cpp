#include "tools/export/geo/geo_datum.hpp"

#include <cmath>

#include "tests/tools/export/exported_map.hpp"

namespace curbstone::map_export {
namespace {

TEST(GeoDatum, IsReadFromTheCommandLine) {
  const auto datum = geo::parse_datum("49.5,-8.25,110.5,45");
  ASSERT_TRUE(datum);
  EXPECT_EQ(datum->latitude, 49.5);
  EXPECT_EQ(datum->longitude, -8.25);
  EXPECT_EQ(datum->altitude, 110.5);
  EXPECT_EQ(datum->heading, 45);
  EXPECT_EQ(geo::parse_datum("49,8")->heading, 90);
  for (const char* bad :
       {"", "49", "49,", "49,8,", "49,8,1,2,3", "91,8", "49,181", "nan,8", "49,inf", "49;8", "49,8 x", "a,b"})
    EXPECT_FALSE(geo::parse_datum(bad)) << bad;
}

TEST(TangentPlane, AgreesWithProjAllOverTheEarth) {
  if (!has_gdal()) GTEST_SKIP() << "no GDAL programs here";
  for (const geo::GeoDatum datum : {geo::GeoDatum{49.011, 8.416, 110, 90}, geo::GeoDatum{-33.9, 151.2, -20, 90},
                                    geo::GeoDatum{0, -179.9999, 0, 90}, geo::GeoDatum{89.9, 30, 2000, 90}}) {
    const geo::TangentPlane plane(datum);
    for (const Eigen::Vector3d& p :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1200, -800, 15), Eigen::Vector3d(-9000, 7000, 200)}) {
      const std::string at = "+lat_0=" + std::to_string(datum.latitude) + " +lon_0=" + std::to_string(datum.longitude) +
                             " +h_0=" + std::to_string(datum.altitude);
      const auto theirs =
          rows_of(output_of("gdaltransform -ct '+proj=pipeline +step +inv +proj=topocentric +ellps=WGS84 " + at +
                                " +step +inv +proj=cart +ellps=WGS84 +step +proj=unitconvert +xy_in=rad +xy_out=deg'",
                            std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + "\n"));
      const geo::GeoPoint ours = plane.to_wgs84(p);
      ASSERT_EQ(theirs.size(), 1U);
      const double shrink = std::cos(ours.latitude * M_PI / 180);
      EXPECT_NEAR(ours.longitude * shrink, theirs[0][0] * shrink, 1e-9);  // 0.1 mm
      EXPECT_NEAR(ours.latitude, theirs[0][1], 1e-9);
      EXPECT_NEAR(ours.altitude, theirs[0][2], 1e-4);
    }
  }
}

TEST(TangentPlane, TurnsTheMapByTheHeadingOfItsXAxis) {
  const Eigen::Vector2d north = geo::TangentPlane({49, 8, 0, 0}).east_north(1, 0);
  EXPECT_TRUE(north.isApprox(Eigen::Vector2d(0, 1)));
  const Eigen::Vector2d y_points_west = geo::TangentPlane({49, 8, 0, 0}).east_north(0, 1);
  EXPECT_TRUE(y_points_west.isApprox(Eigen::Vector2d(-1, 0)));
  EXPECT_EQ(geo::TangentPlane({49, 8, 0, 90}).east_north(3, 4), Eigen::Vector2d(3, 4));
  EXPECT_TRUE(geo::TangentPlane({49, 8, 0, 180}).east_north(1, 0).isApprox(Eigen::Vector2d(0, -1)));
}

}  // namespace
}  // namespace curbstone::map_export
