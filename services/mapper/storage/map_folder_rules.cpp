#include "services/mapper/storage/map_folder_rules.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "services/mapper/dense_map/dense_tile.hpp"

namespace curbstone::mapper::storage {

namespace fs = std::filesystem;

namespace {

/// A voxel's side in kPositionStep; 0 if the dense map cannot have it.
int voxel_steps_of(double voxel) {
  constexpr int kMin = 10, kMax = 250;
  const double steps = voxel / kPositionStep;
  if (!(steps > kMin - 0.5 && steps < kMax + 0.5) || std::abs(steps - std::round(steps)) > 1e-6) return 0;
  const int whole = static_cast<int>(std::lround(steps));
  return kStepsPerTile % whole == 0 ? whole : 0;
}

void check_map_pose(const Pose& pose, const fs::path& file, std::size_t index) {
  const Eigen::Matrix3d R = pose.linear();
  if (!pose.matrix().allFinite() || !(R * R.transpose()).isIdentity(1e-6) || R.determinant() < 0)
    fail_map(file, fmt::format("row {}: is no pose", index));
}

}  // namespace

fs::path map_tile_file(TileKey key) {
  return fs::path("tiles") / fmt::format("{}_{}.pcd", key.x, key.y);
}

fs::path keyframe_file(std::size_t index) {
  return fs::path("nodes") / fmt::format("{:06}.pcd", index);
}

void fail_map(const fs::path& file, const std::string& what) {
  throw MapFolderError(fmt::format("{}: {}", file.string(), what));
}

int check_map_head(const SavedMap& map, const fs::path& file) {
  const int steps = voxel_steps_of(map.voxel);
  if (steps == 0)
    fail_map(file, fmt::format("voxel {}: expected 0.02 to 0.5, whole 2 mm steps that divide 3 m", map.voxel));
  if (map.epoch < 0) fail_map(file, fmt::format("epoch {}: expected 0 or more", map.epoch));
  return steps;
}

void check_map_tile(const SavedTile& tile, int voxel_steps, const fs::path& file) {
  using Rules = MapFolderRules;
  const auto is_near = [](std::int32_t key) { return key >= -Rules::kMaxTileKey && key <= Rules::kMaxTileKey; };
  if (!is_near(tile.key.x) || !is_near(tile.key.y)) fail_map(file, "lies more than 32 km from the map's origin");
  if (tile.z_origin < -Rules::kMaxZOrigin || tile.z_origin > Rules::kMaxZOrigin)
    fail_map(file, fmt::format("z_origin {}: expected a height in m", tile.z_origin));
  if (tile.utime < 0 || tile.utime > Rules::kMaxUtime) fail_map(file, fmt::format("utime {}: is no time", tile.utime));
  if (tile.points.size() > Rules::kMaxTilePoints) fail_map(file, fmt::format("{} points", tile.points.size()));
  dense_map::DenseTile voxels(tile.z_origin, voxel_steps);
  for (std::size_t i = 0; i < tile.points.size(); ++i) {
    const TilePoint& p = tile.points[i];
    if (p.x < 0 || p.x >= kStepsPerTile || p.y < 0 || p.y >= kStepsPerTile)
      fail_map(file, fmt::format("point {} lies outside its tile", i));
    if (voxels.occupied(voxels.voxel_number(p))) fail_map(file, fmt::format("point {} is in another's voxel", i));
    voxels.append(p, tile.utime, 0);
  }
}

void check_keyframe(const scan::Keyframe& node, const fs::path& file, std::size_t index) {
  check_map_pose(node.T_map_base, file, index);
  if (node.utime < 0 || node.utime > MapFolderRules::kMaxUtime)
    fail_map(file, fmt::format("row {}: utime {} is no time", index, node.utime));
  if (node.points.size() > MapFolderRules::kMaxNodePoints)
    fail_map(file, fmt::format("row {}: {} points", index, node.points.size()));
}

void check_map_edge(const pose_graph::PoseEdge& edge, std::size_t nodes, const fs::path& file, std::size_t index) {
  const auto is_node = [&](int i) { return i >= 0 && static_cast<std::size_t>(i) < nodes; };
  if (!is_node(edge.from) || !is_node(edge.to) || edge.from == edge.to)
    fail_map(file, fmt::format("row {}: {} to {} of {} nodes is no edge", index, edge.from, edge.to, nodes));
  check_map_pose(edge.T_from_to, file, index);
  const registration::Matrix6& m = edge.information;
  if (!m.allFinite() || !m.isApprox(m.transpose(), 1e-6) || m.diagonal().minCoeff() < 0)
    fail_map(file, fmt::format("row {}: is no information matrix", index));
}

}  // namespace curbstone::mapper::storage
