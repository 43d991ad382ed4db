#include "services/semantic_map/cells/driven_cells.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

namespace curbstone::semantic_map::cells {
namespace {

Pose pose_at(double x, double y, double yaw) {
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(x, y, 0.3);
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

VehicleConfig vehicle() {
  VehicleConfig v;
  v.length = 1.8;  // 15 cells
  v.width = 1.2;   // 10 cells
  return v;
}

std::size_t index(int column, int row) {
  return static_cast<std::size_t>(row * kCellsPerTile + column);
}

TEST(DrivenCells, AreThoseBeneathTheVehicle) {
  const auto tiles = cells_beneath(pose_at(1.5, 1.44, 0), vehicle());
  ASSERT_EQ(tiles.size(), 1U);
  const CellBits& cells = tiles.at({0, 0});
  EXPECT_EQ(cells.count(), 150U);
  EXPECT_TRUE(cells[index(5, 7)]);
  EXPECT_TRUE(cells[index(19, 16)]);
  EXPECT_FALSE(cells[index(4, 12)]);
  EXPECT_FALSE(cells[index(12, 6)]);
}

TEST(DrivenCells, TurnWithTheVehicleAndLieInAllTilesThatItTouches) {
  const auto tiles = cells_beneath(pose_at(0, -0.06, M_PI_2), vehicle());
  EXPECT_EQ(tiles.size(), 4U);
  std::size_t count = 0;
  for (const auto& [key, cells] : tiles) count += cells.count();
  EXPECT_EQ(count, 150U);
  EXPECT_TRUE(tiles.at({0, 0})[index(4, 6)]);
  EXPECT_FALSE(tiles.at({0, 0})[index(5, 0)]) << "0.66 m beside the path";
}

TEST(DrivenCells, LieWhereTheVehiclesMiddleIs) {
  VehicleConfig car = vehicle();
  car.middle = 1.2;
  EXPECT_EQ(cells_beneath(pose_at(0.3, 1.44, 0), car), cells_beneath(pose_at(1.5, 1.44, 0), vehicle()));
}

TEST(DrivenCells, ThereAreNoneOffTheMap) {
  EXPECT_TRUE(cells_beneath(pose_at(1e300, 0, 0), vehicle()).empty());
}

class DrivenRoad : public testing::Test {
 protected:
  void SetUp() override {
    model_->rough = ground::Plane{};
    model_->rough->height = 0.5;
    models_.set(0, 0, model_.get());
    tile_.height.fill(tile::MapTile::kNoHeight);
    tile_.cost.fill(255);
    driven_.set(index(3, 4));
  }
  void drive() { add_driven_road(*columns_, driven_, vehicles_, ground::GroundSurface(models_), tile_); }

  std::unique_ptr<ground::GroundModel> model_ = std::make_unique<ground::GroundModel>();
  tile::Around<ground::GroundModel> models_;
  std::unique_ptr<CellColumns> columns_ = std::make_unique<CellColumns>();
  VehicleCells vehicles_;
  CellBits driven_;
  tile::MapTile tile_;
};

TEST_F(DrivenRoad, IsRoadAtTheHeightOfTheGroundThoughNothingWasSeenThere) {
  drive();
  const std::size_t i = index(3, 4);
  EXPECT_EQ(tile_.cell_class[i], tile::CellClass::kRoad);
  EXPECT_TRUE(tile_.is_interpolated(i));
  EXPECT_EQ(tile_.cost[i], 0);
  EXPECT_EQ(tile_.height[i], 250);
  EXPECT_EQ(tile_.cell_class[index(4, 4)], tile::CellClass::kUnknown) << "not driven over";
}

TEST_F(DrivenRoad, HasNoHeightWhereNoGroundIsNear) {
  model_->rough.reset();
  drive();
  EXPECT_EQ(tile_.cell_class[index(3, 4)], tile::CellClass::kRoad);
  EXPECT_EQ(tile_.height[index(3, 4)], tile::MapTile::kNoHeight);
}

TEST_F(DrivenRoad, DoesNotReplaceWhatWasSeen) {
  tile_.cell_class[index(3, 4)] = tile::CellClass::kWall;
  drive();
  EXPECT_EQ(tile_.cell_class[index(3, 4)], tile::CellClass::kWall);
  tile_.cell_class[index(3, 4)] = tile::CellClass::kUnknown;
  columns_->cells[index(3, 4)].blocking_points = 1;
  drive();
  EXPECT_EQ(tile_.cell_class[index(3, 4)], tile::CellClass::kUnknown) << "something stands there by now";
}

}  // namespace
}  // namespace curbstone::semantic_map::cells
