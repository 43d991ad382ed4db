#include "services/semantic_map/kerbstones.hpp"

#include <gtest/gtest.h>

namespace curbstone::semantic_map {
namespace {

/// Along x at `y`, from 0 to 10 m; the high side is towards larger y if `rises`, else towards smaller.
tile::CurbLine kerb(float y, bool rises = true) {
  tile::CurbLine line;
  for (int i = 0; i <= 50; ++i)
    line.points.push_back(
        {.x = 0.2F * static_cast<float>(i), .y = y, .height = 0.12F, .high_side_y = rises ? 1.F : -1.F});
  return line;
}

TEST(Kerbstones, PartThePavementFromTheRoadAndNotTheRoadFromItself) {
  const Kerbstones kerbs({kerb(3), kerb(-3, false)});
  for (const double x : {0.5, 3.31, 5.0, 7.77}) {
    EXPECT_TRUE(kerbs.separates({x, 0}, {x + 1, 4}));
    EXPECT_TRUE(kerbs.separates({x, 0}, {x + 1, -6}));
    EXPECT_FALSE(kerbs.separates({x, 0}, {x + 1, 2.5}));
    EXPECT_FALSE(kerbs.separates({x, 0}, {x, -2.5}));
  }
  EXPECT_FALSE(kerbs.separates({12, 0}, {12, 6})) << "beyond its end";
  EXPECT_FALSE(kerbs.separates({5, 1}, {5, 1})) << "no way at all";
}

TEST(Kerbstones, DoNotPartTheOtherCarriagewayBeyondAnIsland) {
  const Kerbstones kerbs({kerb(3), kerb(5, false)});
  EXPECT_TRUE(kerbs.separates({5, 0}, {5, 4})) << "on the island";
  EXPECT_FALSE(kerbs.separates({5, 0}, {5, 7}));
}

TEST(Kerbstones, LoweredOnesPartNothingAndThoseBehindParkedVehiclesDo) {
  tile::CurbLine lowered = kerb(3);
  lowered.dropped = true;
  EXPECT_FALSE(Kerbstones({lowered}).separates({5, 0}, {5, 4}));
  EXPECT_TRUE(Kerbstones({lowered}).contains({5, 3.2})) << "but they are stones";
  tile::CurbLine inferred = kerb(3);
  inferred.inferred = true;
  EXPECT_TRUE(Kerbstones({inferred}).separates({5, 0}, {5, 4}));
}

TEST(Kerbstones, LoweredOnesAndThoseThatLieFlushPartADrivewayFromTheRoadWhereAllCount) {
  tile::CurbLine lowered = kerb(3);
  lowered.dropped = true;
  const auto all = Kerbstones::Which::kAll;
  EXPECT_TRUE(Kerbstones({lowered}).separates({5, 0}, {5, 4}, all));
  EXPECT_FALSE(Kerbstones({lowered}).separates({5, 0}, {5, 2.5}, all));
  EXPECT_FALSE(Kerbstones({kerb(3), lowered, kerb(5, false)}).separates({5, 0}, {5, 7}, all)) << "beyond an island";
  tile::CurbLine before = kerb(-3, false);  // its high side is on its right
  tile::CurbLine behind = before;
  for (tile::CurbVertex& v : behind.points) v.x += 13;
  EXPECT_FALSE(Kerbstones({before, behind}).separates({11.5, 0}, {11.5, -4}));
  EXPECT_TRUE(Kerbstones({before, behind}).separates({11.5, 0}, {11.5, -4}, all)) << "flush between the two";
}

TEST(Kerbstones, NoWayIsTooSlantedToBeParted) {
  const Kerbstones kerbs({kerb(3)});
  for (int degrees = 10; degrees <= 170; ++degrees) {
    const double turn = degrees * M_PI / 180;
    const Eigen::Vector2d crossing(5.07, 3);
    const Eigen::Vector2d way(std::cos(turn), std::sin(turn));
    EXPECT_TRUE(kerbs.separates(crossing - 2 * way, crossing + 2 * way)) << degrees;
  }
}

}  // namespace
}  // namespace curbstone::semantic_map
