#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/config/vehicle.hpp"
#include "tools/simulate/motion/town_motion.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate::world {
namespace {

TEST(Town, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const world::Town a({.seed = 5}), b({.seed = 5}), c({.seed = 6});
  ASSERT_EQ(a.scene->shapes().size(), b.scene->shapes().size());
  for (std::size_t i = 0; i < a.scene->shapes().size(); ++i)
    EXPECT_EQ(a.scene->shapes()[i].centre, b.scene->shapes()[i].centre);
  EXPECT_EQ(a.scene->ground().height_at(10, 10), b.scene->ground().height_at(10, 10));
  EXPECT_NE(a.streets.front().length(), c.streets.front().length());
}

TEST(Town, OnAnotherDayHasOtherCarsAndBinsAndNothingElseIsOther) {
  const auto shapes_of = [](std::uint64_t day, bool passing) {
    std::vector<std::array<float, 6>> found;
    const Town town({.seed = 5, .day = day});
    for (const Shape& s : town.scene->shapes()) {
      if ((s.surface == Surface::kCar || s.surface == Surface::kBin) == passing)
        found.push_back({s.centre.x(), s.centre.y(), s.centre.z(), s.half.x(), s.half.y(), s.half.z()});
    }
    std::sort(found.begin(), found.end());
    return found;
  };
  EXPECT_EQ(shapes_of(7, false), shapes_of(0, false));
  EXPECT_NE(shapes_of(7, true), shapes_of(0, true));
  EXPECT_NE(shapes_of(7, true), shapes_of(8, true));
  EXPECT_EQ(shapes_of(7, true), shapes_of(7, true));
  EXPECT_GT(shapes_of(7, true).size(), 10U);
  EXPECT_EQ(Town({.seed = 5, .day = 7}).scene->ground().height_at(10, 10),
            Town({.seed = 5}).scene->ground().height_at(10, 10));
}

TEST(Town, AStraightStreetHasNothingButCurbsAlongItsMiddle) {
  const Town town({.seed = 5, .straight = 400});
  const Street& street = town.streets.front();
  EXPECT_NEAR(street.length(), 400, 1);
  const Eigen::Vector2d from = street.at(0).point, along = street.at(0).tangent;
  EXPECT_LT((street.at(400).tangent - along).norm(), 1e-6);
  int beside_its_ends = 0;
  for (const Shape& shape : town.scene->shapes()) {
    const double s = (Eigen::Vector2d(shape.centre.x(), shape.centre.y()) - from).dot(along);
    EXPECT_TRUE(s < 120 || s > 290) << s << ": a plot that begins before the middle ends in it";
    ++beside_its_ends;
  }
  EXPECT_GT(beside_its_ends, 50);
  EXPECT_TRUE(town.cars.empty());
  const auto at = street.at(200);
  const auto height = [&](double left) {
    const Eigen::Vector2d p = at.point + left * at.normal();
    return town.scene->ground().height_at(static_cast<float>(p.x()), static_cast<float>(p.y()));
  };
  EXPECT_GT(height(street.half_width() + 0.4) - height(street.half_width() - 0.4), 0.01F) << "a curb, if a dropped one";
  const auto route = motion::TownRoute::along(town);
  EXPECT_FALSE(route.closed());
  EXPECT_NEAR(route.length(), 380, 3);
}

class Towns : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Towns, testing::Range(1, 7));

TEST_P(Towns, LeaveTheVehiclesWayFree) {
  const world::Town town({.seed = static_cast<std::uint64_t>(GetParam())});
  const VehicleConfig vehicle;
  const world::Street& loop = town.streets.front();
  for (double s = 0; s < loop.length(); s += 0.25) {
    const auto at = loop.at(s);
    for (const double off : {-0.5, 0.0, 0.5}) {
      const Eigen::Vector2d p = at.point + (town.options.lane_offset + off * vehicle.width) * at.normal();
      const auto x = static_cast<float>(p.x()), y = static_cast<float>(p.y());
      EXPECT_LT(town.scene->ground().at(x, y).distance, -1.0F) << "on the carriageway";
      for (const auto& shape : town.scene->shapes()) {
        const bool hangs_over =
            shape.bottom() > town.scene->ground().height_at(x, y) + static_cast<float>(vehicle.height);
        EXPECT_TRUE(hangs_over || !shape.covers(x, y, 0.2F)) << "at s = " << s;
      }
    }
  }
}

TEST_P(Towns, HaveCurbsAndSlopesAsBuilt) {
  const world::Town town({.seed = static_cast<std::uint64_t>(GetParam())});
  const world::Street& loop = town.streets.front();
  int dropped = 0, full = 0;
  for (const world::Side side : {world::Side::kLeft, world::Side::kRight}) {
    for (double s = 0; s < loop.length(); s += 0.5) {
      const double h = loop.curb(side).height(s, loop.length(), true);
      EXPECT_GE(h, 0.015);
      EXPECT_LE(h, 0.151);
      (h < 0.04 ? dropped : full) += 1;
      const double ahead = loop.curb(side).height(s + 0.5, loop.length(), true);
      EXPECT_LT(std::abs(ahead - h), 0.12) << "curbs do not jump along the street";
    }
  }
  EXPECT_GT(dropped, full / 20);
  EXPECT_LT(dropped, full / 2);
  for (double s = 0; s < loop.length(); s += 5) {
    const auto a = loop.at(s).point, b = loop.at(s + 5).point;
    const auto height = [&](const Eigen::Vector2d& p) {
      return static_cast<double>(town.scene->ground().height_at(static_cast<float>(p.x()), static_cast<float>(p.y())));
    };
    EXPECT_LT(std::abs(height(b) - height(a)), 0.05 * 5);
  }
}

TEST_P(Towns, AreAsSteepAsIsAskedFor) {
  const world::Town town({.seed = static_cast<std::uint64_t>(GetParam()), .steepness = 0.4});
  const world::Street& loop = town.streets.front();
  double steepest = 0;
  for (double s = 0; s < loop.length(); s += 5) {
    const auto height = [&](double at) {
      const Eigen::Vector2f p = loop.at(at).point.cast<float>();
      return static_cast<double>(town.scene->ground().height_at(p.x(), p.y()));
    };
    steepest = std::max(steepest, std::abs(height(s + 5) - height(s)) / 5);
  }
  EXPECT_GT(steepest, 0.08);
  EXPECT_LT(steepest, 0.41);
}

TEST_P(Towns, LetCarsDriveOnTheRoad) {
  const world::Town town({.seed = static_cast<std::uint64_t>(GetParam())});
  std::vector<world::Shape> cars;
  for (double t = 0; t < 60; t += 3) {
    town.place_cars(t, cars);
    ASSERT_FALSE(cars.empty());
    for (const auto& part : cars) EXPECT_LT(town.scene->ground().at(part.centre.x(), part.centre.y()).distance, -0.5F);
  }
}

TEST(TownMotion, StandsOnTheGroundWithBothWheels) {
  const world::Town town({.seed = 1});
  const VehicleConfig vehicle;
  const motion::TownMotion motion(town, vehicle, motion::SpeedProfile({}, 120));
  for (double t = 0; t < 120; t += 0.7) {
    const Pose T = motion.T_world_base(t);
    for (const double side : {-0.5, 0.5}) {
      const Eigen::Vector3d wheel = T * Eigen::Vector3d(0, side * vehicle.track_width, 0);
      const auto ground = static_cast<double>(
          town.scene->ground().height_at(static_cast<float>(wheel.x()), static_cast<float>(wheel.y())));
      EXPECT_NEAR(wheel.z(), ground, 0.012) << t;
    }
  }
}

}  // namespace
}  // namespace curbstone::simulate::world
