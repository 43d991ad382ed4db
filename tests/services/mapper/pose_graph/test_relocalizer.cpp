#include "services/mapper/pose_graph/relocalizer.hpp"

#include <gtest/gtest.h>

#include "services/mapper/registration/normal_equations.hpp"
#include "tests/services/mapper/synthetic_world.hpp"

namespace curbstone::mapper::pose_graph {
namespace {

using test::pose;

/// A yard that looks unlike the street.
test::SyntheticWorld yard() {
  test::SyntheticWorld world;
  world.boxes = {{{-14, -9, 0}, {-13, 11, 4}}, {{9, -12, 0}, {10, 4, 4}}, {{-12, 11, 0}, {4, 12, 5}},
                 {{-8, -12, 0}, {3, -11, 3}},  {{5, 6, 0}, {7, 9, 2.5}},  {{-7, -4, 0}, {-5, -2, 3}}};
  return world;
}

/// Nodes along a drive in a world that may be another than the drive shown before.
struct Remembered {
  test::SyntheticWorld street = test::street();
  test::SyntheticWorld elsewhere = yard();
  config::AtlasConfig config;
  Atlas atlas{config};
  Relocalizer finder{config::IcpConfig{}, test::default_lidar().translation()};

  Remembered() { street.noise = elsewhere.noise = 0.02; }
  static std::vector<scan::LidarPoint> scan(const test::SyntheticWorld& world, double x) {
    return world.snapshot(test::pose(x, 0, 0, 0, 0, 0), test::default_lidar());
  }
  void visit(const test::SyntheticWorld& world, double from, double to, double shift) {
    for (double x = from; x <= to; x += 2)
      (void)atlas.visit(static_cast<std::int64_t>((x + shift) * 1e6), test::pose(x + shift, 0, 0, 0, 0, 0),
                        scan(world, x));
  }
};

constexpr double kFarOff = 200.0;  // m, a guess that says nothing

TEST(Relocalizer, WhatWasTakenBackIsNotSoughtAnyMoreAndWhatCameInItsPlaceIs) {
  Remembered all;
  all.visit(all.street, -10, 10, 100);
  const int size = all.atlas.size();
  const Pose lost = test::pose(100, 0, 0, 0, 0, 0);
  ASSERT_TRUE(all.finder.find(all.atlas, Remembered::scan(all.street, 1.0), lost, kFarOff));

  all.atlas.roll_back(0);
  ASSERT_EQ(all.atlas.size(), 0);
  all.finder.clear();
  all.visit(all.elsewhere, -10, 10, 500);
  ASSERT_GE(all.atlas.size(), size) << "the numbers are taken again";
  const auto found = all.finder.find(all.atlas, Remembered::scan(all.elsewhere, 1.0), lost, kFarOff);
  ASSERT_TRUE(found);
  EXPECT_LT(registration::log_of(found->T_map_base.inverse() * test::pose(501, 0, 0, 0, 0, 0)).norm(), 0.05);
  EXPECT_FALSE(all.finder.find(all.atlas, Remembered::scan(all.street, 1.0), lost, kFarOff));
}

}  // namespace
}  // namespace curbstone::mapper::pose_graph
