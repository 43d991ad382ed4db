#include "services/mapper/mounting/ground_plane_estimator.hpp"

#include <algorithm>
#include <cmath>

#include "common/linear/decompositions.hpp"
#include "common/statistics/quantile.hpp"

namespace curbstone::mapper::mounting {
namespace {

constexpr float kCellLength = 1.0F;   // m
constexpr float kCellWidth = 0.5F;    // m
constexpr float kHalfLength = 12.0F;  // m ahead, and as far behind
constexpr float kHalfWidth = 2.0F;    // m to either side
constexpr float kBin = 0.02F;         // m
constexpr float kLowest = -1.5F;      // m
constexpr std::size_t kMinCells = 12;
constexpr double kMinInliers = 0.6;    // share of the cells
constexpr double kCoarseScale = 0.15;  // m: points this far off the plane get a small weight in the first iterations,
constexpr double kFineScale = 0.03;    // and in the last ones only points this near count
constexpr std::array kSlopes = {-0.1, -0.05, 0.0, 0.05, 0.1};  // initial slopes of the search
constexpr double kSpreadAlong = 2.0;   // m, RMS of the cells' positions: below it the slope is not observable
constexpr double kSpreadAcross = 0.5;  // m

struct Height {
  Eigen::Vector3d place;  // 1, x, y
  double z;
};

struct Fit {
  Eigen::Vector3d plane;
  Eigen::Matrix3d H;
  double agreement = 0;  // sum of the weights
  double inliers = 0;
};

/// Robust fit to most of the heights, starting from a slope; a kerb beside the lane does not bias it.
std::optional<Fit> fit_from(const std::vector<Height>& heights, double along, double across) {
  Fit fit{{0, along, across}, Eigen::Matrix3d::Zero()};
  std::vector<double> offs;
  for (const Height& height : heights) offs.push_back(height.z - fit.plane.dot(height.place));
  fit.plane[0] = quantile_in_place(offs, 0.5);
  for (double reach = kCoarseScale;; reach = std::max(0.8 * reach, kFineScale)) {
    fit.H.setZero();
    fit.agreement = fit.inliers = 0;
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const Height& height : heights) {
      const double off = (height.z - fit.plane.dot(height.place)) / reach;
      if (std::abs(off) >= 1) continue;
      const double weight = (1 - off * off) * (1 - off * off);  // Tukey
      fit.agreement += weight;
      fit.inliers += 1;
      fit.H += weight * height.place * height.place.transpose();
      b += weight * height.z * height.place;
    }
    const Ldlt<3> solver(fit.H);
    if (!(solver.least_pivot() > 1e-6)) return std::nullopt;
    fit.plane = solver.solve(b);
    if (reach <= kFineScale) return fit;
  }
}

}  // namespace

double GroundPlaneEstimator::Cell::median() const {
  int below = 0;
  std::size_t bin = 0;
  while (bin + 1 < heights.size() && below + heights[bin] <= count / 2) below += heights[bin++];
  // Interpolated within the bin as if its values were spread evenly.
  const double share = heights[bin] > 0 ? (0.5 * count - below) / heights[bin] : 0.5;
  return static_cast<double>(kLowest) + static_cast<double>(kBin) * (static_cast<double>(bin) + share);
}

void GroundPlaneEstimator::Cell::halve() {
  count = 0;
  for (std::uint16_t& height : heights) {
    height = static_cast<std::uint16_t>(height / 2);
    count += height;
  }
}

void GroundPlaneEstimator::add(const std::vector<scan::LidarPoint>& points) {
  std::vector<std::vector<double>> seen(cells_.size());
  for (const scan::LidarPoint& point : points) {
    const Eigen::Vector3f& p = point.position;
    const float column = std::floor((p.x() + kHalfLength) / kCellLength);
    const float row = std::floor((p.y() + kHalfWidth) / kCellWidth);
    const bool inside = column >= 0 && column < kColumns && row >= 0 && row < kRows;
    if (!inside || !(p.z() >= kLowest && p.z() < kLowest + kBin * kBins)) continue;
    seen[static_cast<std::size_t>(column) * kRows + static_cast<std::size_t>(row)].push_back(p.z());
  }
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (seen[i].empty()) continue;
    const double z = quantile_in_place(seen[i], 0.5);
    const int bin = static_cast<int>((z - static_cast<double>(kLowest)) / static_cast<double>(kBin));
    ++cells_[i].heights[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1))];
    ++cells_[i].count;
  }
  if (++num_revolutions_ < 2 * kMinRevolutions) return;
  num_revolutions_ /= 2;
  for (Cell& cell : cells_) cell.halve();
}

std::optional<GroundPlane> GroundPlaneEstimator::plane() const {
  if (num_revolutions_ < kMinRevolutions) return std::nullopt;
  std::vector<Height> heights;
  for (int column = 0; column < kColumns; ++column) {
    for (int row = 0; row < kRows; ++row) {
      const Cell& cell = cells_[static_cast<std::size_t>(column * kRows + row)];
      if (cell.count < num_revolutions_ / 4) continue;
      heights.push_back({{1.0, static_cast<double>(kCellLength) * (column + 0.5) - static_cast<double>(kHalfLength),
                          static_cast<double>(kCellWidth) * (row + 0.5) - static_cast<double>(kHalfWidth)},
                         cell.median()});
    }
  }
  if (heights.size() < kMinCells) return std::nullopt;
  std::optional<Fit> best;
  for (const double along : kSlopes) {
    for (const double across : kSlopes) {
      const auto fit = fit_from(heights, along, across);
      if (fit && (!best || fit->agreement > best->agreement)) best = fit;
    }
  }
  if (!best || best->inliers < kMinInliers * static_cast<double>(heights.size())) return std::nullopt;
  const Eigen::Matrix3d& H = best->H;
  const double x = H(0, 1) / H(0, 0), y = H(0, 2) / H(0, 0);
  if (H(1, 1) / H(0, 0) - x * x < kSpreadAlong * kSpreadAlong) return std::nullopt;
  if (H(2, 2) / H(0, 0) - y * y < kSpreadAcross * kSpreadAcross) return std::nullopt;
  return GroundPlane{best->plane[0], best->plane[1], best->plane[2]};
}

}  // namespace curbstone::mapper::mounting
