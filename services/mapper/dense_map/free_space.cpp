#include "services/mapper/dense_map/free_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "services/mapper/voxels/flat_index.hpp"

namespace curbstone::mapper::dense_map {
namespace {

constexpr int kCellSteps = 100;                      // 0.2 m
constexpr int kAcross = kStepsPerTile / kCellSteps;  // cells along a tile's side
constexpr int kLayers = 60;                          // cells, half of them below the lidar
constexpr int kLayer = kAcross * kAcross;            // cells in one
constexpr int kBelowAll = 400;                       // cells: below every int16
constexpr auto kRecordStep = static_cast<float>(kPositionStep);
constexpr std::uint8_t kMinScansThrough = 2;        // scans whose beams passed through, for a point to count as free
constexpr std::uint8_t kMaxScansThrough = 4;        // scans that are counted at most
constexpr int kMinScansThroughColumn = 3;           // the same for a column
constexpr float kLowClearance = 0.06F;              // m above the column's lowest point, below an object that is gone
constexpr RangeImage::Margins kHigh{0.30F, 0.50F};  // m: the depth of an obstacle, and a clear margin beyond
constexpr RangeImage::Margins kLow{0.12F, 0.15F};   // m: near the ground
static_assert(DenseTile::kVacatedColumns == kAcross);

}  // namespace

FreeSpace::FreeSpace(double ground_clearance)
    : ground_clearance_(static_cast<float>(ground_clearance)), cells_(kLayers * kLayer) {}

/// The points that may be tested by their height, of the records from `begin` on: most are ground, and are left out
/// without a branch, as points of ground and of walls come in no order.
void FreeSpace::list_tall(DenseTile& tile, const TileRecords& content, std::size_t begin, std::size_t end) {
  const float least = tile.any_vacated() ? std::min(kLowClearance, ground_clearance_) : ground_clearance_;
  const auto z_origin = static_cast<float>(tile.z_origin());
  tall_.resize(std::max(tall_.size(), end - begin));
  std::size_t size = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const TilePoint& p = content.records[i];
    const float above = z_origin + kRecordStep * static_cast<float>(p.z) - tile.lowest_at(p);
    tall_[size] = {static_cast<std::uint32_t>(i), above};
    size += static_cast<std::size_t>(tile.is_present(i)) & static_cast<std::size_t>(above > least);
  }
  tall_.resize(size);
}

/// First pass: the occupancy of each candidate, and the cells in which a beam ended.
void FreeSpace::gather(DenseTile& tile, const Eigen::Vector3d& corner, const View& view) {
  const Eigen::Vector3d lidar = view.T_lidar_map.inverse().translation();
  const int layers_below = voxels::floor_to_int((lidar.z() - corner.z()) / (kCellSteps * kPositionStep)) - kLayers / 2;
  const Eigen::Matrix3f turn = view.T_lidar_map.linear().cast<float>();
  const Eigen::Vector3f offset = (view.T_lidar_map * corner).cast<float>();
  const auto reach2 = static_cast<float>(view.reach * view.reach);
  const std::shared_ptr<const TileRecords> content = tile.read();  // it is awake
  for (std::size_t run = 0; run < content->runs.size(); ++run) {
    if (!view.in_place(content->runs[run].anchor)) continue;
    const std::size_t end = content->end_of(run);
    list_tall(tile, *content, static_cast<std::size_t>(content->runs[run].first), end);
    for (const auto& [i, above] : tall_) {
      const TilePoint& p = content->records[i];
      const int column = p.y / kCellSteps * kAcross + p.x / kCellSteps;
      const bool high = above > ground_clearance_;
      if (!high && !(above > kLowClearance && tile.vacated(column))) continue;
      const int layer = (p.z + kBelowAll * kCellSteps) / kCellSteps - kBelowAll - layers_below;
      if (layer < 0 || layer >= kLayers) continue;
      const Eigen::Vector3f in_lidar = offset + turn * (kRecordStep * Eigen::Vector3f(p.x, p.y, p.z));
      if (in_lidar.squaredNorm() > reach2) continue;
      const auto cell = static_cast<std::uint32_t>(layer * kLayer + column);
      const Occupancy occupancy = view.image.classify(in_lidar, high ? kHigh : kLow);
      ++cells_[cell].points;
      cells_[cell].hit |= occupancy == Occupancy::kOccupied;
      candidates_.push_back({i, cell, occupancy == Occupancy::kFree});
    }
  }
}

/// Whether a beam ended in the cell or in one that shares a face with it, within the tile.
bool FreeSpace::hit_nearby(std::uint32_t cell) const {
  if (cells_[cell].hit) return true;
  const int x = static_cast<int>(cell) % kAcross, y = static_cast<int>(cell) / kAcross % kAcross;
  const int z = static_cast<int>(cell) / kLayer;
  return (x > 0 && cells_[cell - 1].hit) || (x + 1 < kAcross && cells_[cell + 1].hit) ||
         (y > 0 && cells_[cell - kAcross].hit) || (y + 1 < kAcross && cells_[cell + kAcross].hit) ||
         (z > 0 && cells_[cell - kLayer].hit) || (z + 1 < kLayers && cells_[cell + kLayer].hit);
}

std::vector<std::uint32_t> FreeSpace::find_removed(DenseTile& tile, const Eigen::Vector3d& corner, const View& view) {
  candidates_.clear();
  gather(tile, corner, view);
  for (const Candidate& candidate : candidates_) {
    std::uint8_t& through = tile.num_passes(candidate.record);
    if ((through > 0 || candidate.through) && hit_nearby(candidate.cell)) {
      through = 0;
    } else if (candidate.through) {
      through = static_cast<std::uint8_t>(std::min<int>(through + 1, kMaxScansThrough));
    }
    cells_[candidate.cell].free += through >= kMinScansThrough ? 1 : 0;
  }
  std::vector<std::uint32_t> gone;
  for (const Candidate& candidate : candidates_) {
    const Cell& cell = cells_[candidate.cell];
    if (cell.free == 0 || 2 * cell.free < cell.points || cell.hit) continue;
    gone.push_back(candidate.record);
    tile.set_vacated(static_cast<int>(candidate.cell) % kLayer);
  }
  for (const Candidate& candidate : candidates_) cells_[candidate.cell] = {};
  return gone;
}

/// As find_removed(), from few beams: all points above a column are gone once beams passed through any of them in
/// kMinScansThroughColumn scans, and none ended there or beside it since.
std::vector<std::uint32_t> FreeSpace::find_left_behind(DenseTile& tile, const Eigen::Vector3d& corner,
                                                       const View& view) {
  candidates_.clear();
  gather(tile, corner, view);
  std::array<bool, kLayer> hit{}, through{};
  for (const Candidate& candidate : candidates_) {
    const std::size_t column = candidate.cell % kLayer;
    hit[column] = hit[column] || cells_[candidate.cell].hit;
    through[column] = through[column] || candidate.through;
  }
  for (const Candidate& candidate : candidates_) cells_[candidate.cell] = {};
  const auto hit_beside = [&](std::size_t column) {
    const std::size_t x = column % kAcross, y = column / kAcross;
    return (x > 0 && hit[column - 1]) || (x + 1 < kAcross && hit[column + 1]) || (y > 0 && hit[column - kAcross]) ||
           (y + 1 < kAcross && hit[column + kAcross]);
  };
  std::array<bool, kLayer> gone{};
  for (std::size_t column = 0; column < kLayer; ++column) {
    if (hit[column] || hit_beside(column))
      tile.set_scans_through(column, 0);
    else if (through[column])
      tile.set_scans_through(column, tile.scans_through(column) + 1);
    gone[column] = tile.scans_through(column) >= kMinScansThroughColumn;
  }
  std::vector<std::uint32_t> records;
  for (const Candidate& candidate : candidates_) {
    if (!gone[candidate.cell % kLayer]) continue;
    records.push_back(candidate.record);
    tile.set_vacated(static_cast<int>(candidate.cell) % kLayer);
  }
  return records;
}

}  // namespace curbstone::mapper::dense_map
