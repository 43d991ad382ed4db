#include "services/localizer/tracking/thinned_scan.hpp"

#include <cmath>

#include "common/tiles/tile.hpp"

namespace curbstone::localizer::tracking {
namespace {

constexpr int kSide = 2 * static_cast<int>(ScanThinner::kReach / kCellSize) + 1;
constexpr float kBoxHeight = 0.25F;  // m; level ground lies in the middle of a box
constexpr int kLowest = -6;          // boxes: 1.5 m below base_link
constexpr int kLayers = 20;          // up to 3.4 m above it

}  // namespace

ScanThinner::ScanThinner() : box_at_(std::size_t{kSide} * kSide * kLayers) {}

std::vector<Eigen::Vector3d> ScanThinner::thin(const std::vector<mapper::scan::LidarPoint>& points) {
  constexpr auto kInverse = static_cast<float>(1.0 / kCellSize);
  boxes_.clear();
  for (const mapper::scan::LidarPoint& point : points) {
    const Eigen::Vector3f& p = point.position;
    if (!(p.head<2>().cwiseAbs().maxCoeff() < static_cast<float>(kReach)) || !(std::abs(p.z()) < 100.0F)) continue;
    const int column = static_cast<int>(std::floor(p.x() * kInverse)) + kSide / 2;
    const int row = static_cast<int>(std::floor(p.y() * kInverse)) + kSide / 2;
    const int layer = static_cast<int>(std::floor(p.z() / kBoxHeight + 0.5F)) - kLowest;
    if (column < 0 || row < 0 || column >= kSide || row >= kSide || layer < 0 || layer >= kLayers) continue;
    const auto place = static_cast<std::uint32_t>((layer * kSide + row) * kSide + column);
    std::uint32_t& index = box_at_[place];
    if (index >= boxes_.size() || boxes_[index].place != place) {
      index = static_cast<std::uint32_t>(boxes_.size());
      boxes_.push_back({place, 0, Eigen::Vector3f::Zero()});
    }
    boxes_[index].count += 1;
    boxes_[index].sum += p;
  }
  std::vector<Eigen::Vector3d> thinned;
  thinned.reserve(boxes_.size());
  for (const Box& box : boxes_) thinned.emplace_back((box.sum / box.count).cast<double>());
  return thinned;
}

}  // namespace curbstone::localizer::tracking
