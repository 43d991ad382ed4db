#include <gtest/gtest.h>

#include <cmath>
#include <curbstone/semantic_tile_t.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/temporary_folder.hpp"
#include "tools/simulate/motion/town_motion.hpp"
#include "tools/simulate/truth/class_grid.hpp"
#include "tools/simulate/truth/curb_lines.hpp"
#include "tools/simulate/truth/truth_folder.hpp"

namespace curbstone::simulate::truth {
namespace {

const world::Town& town() {
  static const world::Town town({.seed = 2});
  return town;
}

std::uint8_t class_at(truth::ClassGrid& grid, double x, double y) {
  const int column = static_cast<int>((x - grid.x0) / grid.resolution),
            row = static_cast<int>((y - grid.y0) / grid.resolution);
  return grid.image.at(column, grid.image.height - 1 - row);
}

TEST(CurbLines, LieOnTheFootOfTheCurbNoMoreThanTenCentimetresApart) {
  const world::Ground& ground = town().scene->ground();
  const auto curbs = truth::trace_curbs(ground);
  ASSERT_GE(curbs.size(), 2U);
  double length = 0;
  for (const auto& curb : curbs) {
    for (std::size_t i = 0; i < curb.size(); ++i) {
      const auto x = static_cast<float>(curb[i].foot.x()), y = static_cast<float>(curb[i].foot.y());
      EXPECT_NEAR(ground.at(x, y).distance, 0.0F, 0.01F);
      EXPECT_NEAR(curb[i].foot.z(), static_cast<double>(ground.height_at(x, y)), 0.05);
      if (i == 0) continue;
      const double step = (curb[i].foot - curb[i - 1].foot).head<2>().norm();
      EXPECT_LE(step, 0.1);
      length += step;
    }
  }
  EXPECT_GT(length, 1.8 * town().streets.front().length()) << "both sides of the loop, side streets' mouths left out";
}

TEST(ClassGrid, HasACurbCellUnderEveryCurbPointThatIsNotDropped) {
  truth::ClassGrid grid = truth::make_class_grid(*town().scene, 2.0);
  int curb_points = 0, found = 0;
  for (const auto& curb : truth::trace_curbs(town().scene->ground())) {
    for (const auto& point : curb) {
      if (point.height < 0.045) continue;  // beside a dropped kerb a cell may be either
      ++curb_points;
      bool near = false;
      for (const double dx : {-0.06, 0.0, 0.06})
        for (const double dy : {-0.06, 0.0, 0.06}) {
          if (!town().scene->ground().inside(point.foot.x() + dx - 0.2, point.foot.y() + dy - 0.2) ||
              !town().scene->ground().inside(point.foot.x() + dx + 0.2, point.foot.y() + dy + 0.2)) {
            near = true;
            continue;
          }
          const auto id = class_at(grid, point.foot.x() + dx, point.foot.y() + dy);
          near = near || id == semantic_tile_t::CURB || id == semantic_tile_t::WALL || id == semantic_tile_t::OBSTACLE;
        }
      found += near ? 1 : 0;
    }
  }
  EXPECT_GE(found, curb_points - curb_points / 1000) << "at the border of the world a cell may be cut off";
}

TEST(ClassGrid, NamesTheRoadWallsCarsBinsAndNotWhatHangsAbove) {
  truth::ClassGrid grid = truth::make_class_grid(*town().scene, 2.0);
  const auto& street = town().streets.front();
  for (double s = 0; s < street.length(); s += 2) {
    const auto at = street.at(s);
    const Eigen::Vector2d p = at.point + town().options.lane_offset * at.normal();
    EXPECT_EQ(class_at(grid, p.x(), p.y()), +semantic_tile_t::ROAD);
  }
  int walls = 0, low = 0, crowns = 0;
  for (const auto& shape : town().scene->shapes()) {
    const auto x = static_cast<double>(shape.centre.x()), y = static_cast<double>(shape.centre.y());
    if (shape.surface == world::Surface::kWall || shape.surface == world::Surface::kCar) {
      ++walls;
      EXPECT_EQ(class_at(grid, x, y), +semantic_tile_t::WALL);
    } else if (shape.surface == world::Surface::kBin) {
      ++low;
      EXPECT_EQ(class_at(grid, x, y), +semantic_tile_t::OBSTACLE);
    } else if (shape.kind == world::Shape::Kind::kEllipsoid) {
      ++crowns;
      EXPECT_NE(class_at(grid, x + 1.0, y), +semantic_tile_t::OBSTACLE);
    }
  }
  EXPECT_GT(walls, 20);
  EXPECT_GT(low, 5);
  EXPECT_GT(crowns, 10);
}

TEST(ClassGrid, OfFinePixelsEndsWhereAWallEnds) {
  truth::ClassGrid fine = truth::make_class_grid(*town().scene, 2.0, truth::fine_resolution(*town().scene));
  ASSERT_LT(fine.resolution, 0.04);
  int walls = 0, alone = 0;
  for (const auto& shape : town().scene->shapes()) {
    if (shape.surface != world::Surface::kWall) continue;
    const Eigen::Vector2d along = Eigen::Vector2f(shape.cos_yaw, shape.sin_yaw).cast<double>();
    const Eigen::Vector2d face = shape.centre.head<2>().cast<double>() + static_cast<double>(shape.half.x()) * along;
    const auto class_beyond = [&](double off) {
      const Eigen::Vector2d at = face + off * along;
      return class_at(fine, at.x(), at.y());
    };
    EXPECT_EQ(class_beyond(-fine.resolution), +semantic_tile_t::WALL);
    ++walls;
    alone += class_beyond(2 * fine.resolution) != semantic_tile_t::WALL ? 1 : 0;
  }
  EXPECT_GT(walls, 20);
  EXPECT_GT(2 * alone, walls) << "the others join on to something";
}

TEST(TruthFolder, IsCompleteAndReadable) {
  const test::TemporaryFolder temporary;
  const std::string folder = temporary / "truth";
  const truth::TruthInfo info{1'750'000'000'000'000, 2, "town", 5.0, 0.004};
  const motion::TownMotion motion(town(), {}, motion::SpeedProfile({}, 5));
  truth::prepare_truth_folder(folder);
  truth::write_drive_truth(folder, info, motion, truth::write_town_truth(folder, town(), {}, 2.0));
  for (const char* name : {"truth.json", "poses.csv", "classes.png", "fine_classes.png", "curbs.csv", "markings.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder + "/" + name)) << name;
  std::ifstream in(folder + "/truth.json");
  const auto json = nlohmann::json::parse(in);
  EXPECT_EQ(json["start_utime"], 1'750'000'000'000'000);
  EXPECT_EQ(json["latest_packet_s"], 0.004);
  EXPECT_EQ(json["resolution_m"], 0.12);
  EXPECT_EQ(json["fine_resolution_m"], 0.03);
  EXPECT_GT(json["width"], 1000);
  std::ifstream poses(folder + "/poses.csv");
  EXPECT_EQ(std::count(std::istreambuf_iterator<char>(poses), {}, '\n'), 502) << "heading and 100 a second";
}

TEST(TruthFolder, SaysSoWhenItCannotBeWritten) {
  EXPECT_THROW(truth::prepare_truth_folder("/proc/no/such"), std::runtime_error);
}

}  // namespace
}  // namespace curbstone::simulate::truth
