#include "services/mapper/journal/journal_codec.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace curbstone::mapper::journal {
namespace {

/// A drive whose only keyframe is at `T_map_base`.
RecordedDrive drive_with(const Pose& T_map_base) {
  scan::Keyframe node;
  node.T_map_base = T_map_base;
  std::string items;
  append_head(items, "", 7, 0);
  append_node(items, node, 0);
  append_pose(items, {1, 1, 0, T_map_base, Pose::Identity(), true, 1, true});
  RecordedDrive drive;
  apply_items(items, drive, 1);
  check_drive(drive);
  return drive;
}

TEST(JournalCodec, GivesBackWhatWasAppended) {
  const Pose T_map_base(Eigen::Translation3d(40'000, -2, 3) * Eigen::AngleAxisd(1, Eigen::Vector3d::UnitZ()));
  const RecordedDrive drive = drive_with(T_map_base);
  EXPECT_EQ(drive.epoch, 7);
  ASSERT_EQ(drive.nodes.size(), 1U);
  EXPECT_EQ(drive.nodes[0].kept.T_map_base.matrix(), T_map_base.matrix());
  EXPECT_EQ(drive.poses[0].T_map_base.matrix(), T_map_base.matrix());
}

TEST(JournalCodec, RefusesAPoseThatNoVehicleHas) {
  EXPECT_THROW(drive_with(Pose(Eigen::Translation3d(1e181, 0, 0))), std::runtime_error) << "its voxel has no key";
  Pose stretched = Pose::Identity();
  stretched.linear() *= 2;
  EXPECT_THROW(drive_with(stretched), std::runtime_error);
  Pose mirrored = Pose::Identity();
  mirrored.linear()(0, 0) = -1;
  EXPECT_THROW(drive_with(mirrored), std::runtime_error);
}

TEST(JournalCodec, RefusesATileThatNoVehicleComesTo) {
  std::string items;
  append_head(items, "", 7, 0);
  append_tile(items, {1'000'000, 0}, 0, {{{1, 2, 3, 4}}, {{-1, 0, 1}}}, 0, 0);
  RecordedDrive drive;
  EXPECT_THROW(apply_items(items, drive, 1), std::runtime_error);
}

}  // namespace
}  // namespace curbstone::mapper::journal
