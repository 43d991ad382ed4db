#include "services/mapper/pose_graph/atlas.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/stamps.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::mapper::pose_graph {
namespace {

using test::kStart;

Pose at(double x, double y, double z = 0) {
  return Pose(Eigen::Translation3d(x, y, z));
}

/// What the vehicle sees of itself: enough to be kept.
std::vector<scan::LidarPoint> surroundings() {
  std::vector<scan::LidarPoint> points;
  for (int i = 0; i < 50; ++i) points.push_back({{0.5F * static_cast<float>(i), 1, 0.3F}, 0, 0, 0});
  return points;
}

class AnAtlas : public testing::Test {
 protected:
  int visit(double x, double y, double z = 0) {
    return atlas_.visit(kStart + 1000 * ++visits_, at(x, y, z), surroundings());
  }
  /// `length` m straight on, in steps of 10 cm.
  void drive(double x0, double y0, double dx, double dy, double length) {
    for (double s = 0; s < length; s += 0.1) visit(x0 + s * dx, y0 + s * dy);
  }

  Atlas atlas_{config::AtlasConfig{}};
  std::int64_t visits_ = 0;
};

TEST_F(AnAtlas, HasANodeEachMetreOfNewGround) {
  drive(0, 0, 1, 0, 50);
  EXPECT_NEAR(atlas_.size(), 50, 5);
  EXPECT_EQ(atlas_.edges().size(), static_cast<std::size_t>(atlas_.size() - 1));
  EXPECT_EQ(atlas_.reference(), atlas_.size() - 1);
  EXPECT_NEAR(atlas_.driven(atlas_.reference()), 50, 1.5);
}

TEST_F(AnAtlas, GrowsNoMoreWhenTheSameRoundIsDrivenAgain) {
  const auto round = [&] {
    for (double a = 0; a < 2 * std::numbers::pi; a += 0.005) visit(20 * std::cos(a), 20 * std::sin(a));
  };
  round();
  const int once = atlas_.size();
  round();
  const std::size_t edges = atlas_.edges().size();
  for (int i = 0; i < 5; ++i) round();
  EXPECT_LE(atlas_.size(), once + 1);
  EXPECT_EQ(atlas_.edges().size(), edges);
}

TEST_F(AnAtlas, ABridgeIsAnotherPlaceThanTheRoadBelow) {
  const int below = visit(0, 0, 0);
  EXPECT_NE(visit(0, 0, 5), below);
}

TEST_F(AnAtlas, WhatRegistrationForgotIsNoPlaceToBeAt) {
  drive(0, 0, 1, 0, 100);
  const int far = atlas_.near({0, 0, 0}, 0.5).front();
  EXPECT_TRUE(atlas_.present(far));
  atlas_.forget_far({100, 0, 0}, 80);
  EXPECT_FALSE(atlas_.present(far));
  EXPECT_TRUE(atlas_.present(atlas_.near({30, 0, 0}, 0.6).front()));
  EXPECT_NE(visit(0, 0), far) << "nothing of it was there to be registered to";
}

TEST_F(AnAtlas, FarNodesReturnWhenTheVehicleTurnsBackButNotRoundALongLoop) {
  drive(0, 0, 1, 0, 100);
  atlas_.forget_far({100, 0, 0}, 80);
  drive(100, 0, -1, 0, 30);
  const std::vector<int> back = atlas_.take_returning({70, 0, 0}, 80);
  EXPECT_FALSE(back.empty());
  for (const int id : back) EXPECT_TRUE(atlas_.present(id));
  EXPECT_TRUE(atlas_.take_returning({70, 0, 0}, 80).empty()) << "once is enough";

  Atlas loop{config::AtlasConfig{}};
  for (double a = 0; a < 1.9 * std::numbers::pi; a += 0.0005) {
    const Eigen::Vector3d p(100 * std::cos(a), 100 * std::sin(a), 0);
    loop.visit(1, Pose(Eigen::Translation3d(p)), surroundings());
    loop.forget_far(p, 80);
    EXPECT_TRUE(loop.take_returning(p, 80).empty()) << a << ": near, but drift has come between";
  }
}

TEST_F(AnAtlas, ALoopConnectsItsEnds) {
  for (double a = 0; a < 1.9 * std::numbers::pi; a += 0.001) visit(100 * std::cos(a), 100 * std::sin(a));
  const int last = atlas_.reference();
  EXPECT_EQ(atlas_.connected(last, 40).front(), last - static_cast<int>(atlas_.connected(last, 40).size()) + 1);
  atlas_.add_loop({0, last, Pose::Identity(), 1e4 * registration::Matrix6::Identity(), true});
  EXPECT_EQ(atlas_.connected(last, 40).front(), 0);
}

TEST_F(AnAtlas, RollingBackForgetsWhatWasMadeSince) {
  drive(0, 0, 1, 0, 20);
  const int before = atlas_.size();
  const std::size_t edges = atlas_.edges().size();
  const std::int64_t good = kStart + 1000 * visits_;
  drive(20, 0, 0, 1, 20);
  EXPECT_GT(atlas_.size(), before);
  atlas_.roll_back(good);
  EXPECT_EQ(atlas_.size(), before);
  EXPECT_EQ(atlas_.edges().size(), edges);
  EXPECT_LT(atlas_.reference(), before);
  drive(20, 0, 0, 1, 20);
  EXPECT_EQ(atlas_.connected(0, 100).size(), static_cast<std::size_t>(atlas_.size())) << "the graph holds together";
}

TEST_F(AnAtlas, KeepsAtMostSoManyScansTheNearest) {
  config::AtlasConfig config;
  config.max_nodes = 30;
  Atlas atlas(config);
  for (double x = 0; x < 100; x += 0.5) atlas.visit(1, at(x, 0), surroundings());
  int scans = 0;
  for (int id = 0; id < atlas.size(); ++id) scans += atlas.node(id).points.empty() ? 0 : 1;
  EXPECT_EQ(scans, 30);
  EXPECT_TRUE(atlas.node(0).points.empty());
  EXPECT_EQ(atlas.near({0, 0, 0}, 10).size(), 0U) << "what has no scan cannot be recognised";
}

TEST_F(AnAtlas, KeepsAllScansThatADiskTakes) {
  const test::TemporaryFolder folder;
  config::AtlasConfig config;
  config.max_nodes = 30;
  Atlas atlas(config, std::make_shared<SpillFile>(folder.path().string(), 0));
  for (double x = 0; x < 100; x += 0.5) atlas.visit(1, at(x, 0), surroundings());
  for (int id = 0; id < atlas.size(); ++id) EXPECT_FALSE(atlas.node(id).points.read()->empty());
}

TEST_F(AnAtlas, ScansOfAllButTheNewestNodesLieInAFile) {
  const test::TemporaryFolder folder;
  const auto file = std::make_shared<SpillFile>(folder.path().string(), 0);
  Atlas atlas(config::AtlasConfig{}, file);
  for (double x = 0; x < 100; x += 0.5) {
    atlas.visit(1, at(x, 0), surroundings());
    atlas_.visit(1, at(x, 0), surroundings());
  }
  int spilled = 0;
  ASSERT_EQ(atlas.size(), atlas_.size());
  for (int id = 0; id < atlas.size(); ++id) {
    spilled += atlas.node(id).points.is_spilled() ? 1 : 0;
    EXPECT_EQ(atlas.node(id).points, atlas_.node(id).points);
  }
  EXPECT_EQ(spilled, atlas.size() - 20);
  file->flush();
  EXPECT_EQ(file->bytes_in_memory(), 0U);
  EXPECT_GT(file->bytes_in_file(), 0U);
}

TEST_F(AnAtlas, KnownNodesFixTheirPlaceAndAreFollowed) {
  scan::Keyframe known;
  known.T_map_base = at(3, 0);
  known.points = std::vector<scan::KeyframePoint>(5);
  const int id = atlas_.add_known(known);
  EXPECT_EQ(atlas_.num_known(), 1);
  EXPECT_FALSE(atlas_.present(id));
  atlas_.set_present({id}, id);
  EXPECT_EQ(visit(3.5, 0), id);
  const int made = visit(5, 0);
  EXPECT_NE(made, id);
  atlas_.follow(at(3.2, 0));
  EXPECT_EQ(atlas_.reference(), id);
  EXPECT_EQ(atlas_.num_known(), 1);
  atlas_.roll_back(0);
  EXPECT_EQ(atlas_.size(), 1) << "what was known stays";
}

}  // namespace
}  // namespace curbstone::mapper::pose_graph
