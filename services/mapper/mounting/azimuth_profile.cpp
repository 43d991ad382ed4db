#include "services/mapper/mounting/azimuth_profile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::mapper::mounting {
namespace {

constexpr float kUpright = 0.5F;       // m above the vehicle's ground: above it no ground, on most roads
constexpr float kSlope = 0.03F;        // and more, farther off
constexpr float kNear = 1.5F;          // m
constexpr float kFar = 60.0F;          // m
constexpr float kOtherSurface = 1.0F;  // m: ranges that differ by more belong to different surfaces
constexpr std::size_t kMinRanges = 300;
constexpr std::size_t kSearchRanges = 500;  // ranges that a search uses; all are used to refine
constexpr double kNearUsual = 1.2;          // times the usual residual

/// The bin of a direction. The arctangent is a polynomial, good to 1e-4 rad: this is most of the time that a profile
/// takes.
std::size_t bin_of(const Eigen::Vector2f& p) {
  const float x = std::abs(p.x()), y = std::abs(p.y());
  const float ratio = std::min(x, y) / std::max({x, y, 1e-6F}), square = ratio * ratio;
  float angle = ratio * (0.99921F + square * (-0.32117F + square * (0.14627F - square * 0.03899F)));
  if (y > x) angle = std::numbers::pi_v<float> / 2 - angle;
  if (p.x() < 0) angle = std::numbers::pi_v<float> - angle;
  if (p.y() < 0) angle = 2 * std::numbers::pi_v<float> - angle;
  return std::min<std::size_t>(static_cast<std::size_t>(angle / static_cast<float>(AzimuthProfile::kBin)),
                               AzimuthProfile::kBins - 1);
}

}  // namespace

AzimuthProfile::AzimuthProfile(const std::vector<scan::LidarPoint>& points, const Pose& T_there_base,
                               const Eigen::Vector3d& lidar) {
  const Eigen::Matrix2f R = T_there_base.linear().topLeftCorner<2, 2>().cast<float>();
  const Eigen::Vector2f t = (T_there_base.translation() - lidar).head<2>().cast<float>();
  const Eigen::Vector2f from = lidar.head<2>().cast<float>();
  for (const scan::LidarPoint& point : points) {
    if (!(point.position.z() > kUpright)) continue;
    const float away = (point.position.head<2>() - from).norm();
    if (!(point.position.z() > kUpright + kSlope * away && away > kNear && away < kFar)) continue;
    const Eigen::Vector2f p = R * point.position.head<2>() + t;
    const std::size_t row = static_cast<std::size_t>(point.ring) * kBins;
    if (ranges_.size() < row + kBins) ranges_.resize(row + kBins);
    float& range = ranges_[row + bin_of(p)];
    const float r = p.norm();
    if (range == 0) seen_.push_back(static_cast<std::uint32_t>(&range - ranges_.data()));
    if (range == 0 || r < range) range = r;
  }
}

bool AzimuthProfile::is_comparable(const AzimuthProfile& other) const {
  return size() >= kMinRanges && other.size() >= kMinRanges;
}

std::optional<double> AzimuthProfile::residual_to(const AzimuthProfile& earlier) const {
  return is_comparable(earlier) ? std::optional(residual(earlier, 0)) : std::nullopt;
}

/// Searches with some of the ranges, and refines with all.
std::optional<AzimuthProfile::Turn> AzimuthProfile::turn_since(const AzimuthProfile& earlier, double usual) const {
  if (!is_comparable(earlier)) return std::nullopt;
  const double at_zero = residual(earlier, 0);
  int best = 0;
  if (at_zero > kNearUsual * usual) {
    const std::size_t stride = std::max<std::size_t>(size() / kSearchRanges, 1);
    double least = residual(earlier, 0, stride);
    for (int bins = -kMaxTurn; bins <= kMaxTurn; ++bins) {
      const double found = residual(earlier, bins, stride);
      if (found < least) least = found, best = bins;
    }
  }
  const double at = best == 0 ? at_zero : residual(earlier, best);
  const double before = residual(earlier, best - 1), after = residual(earlier, best + 1);
  const double bend = before - 2 * at + after;
  const double beside = bend > 0 ? std::clamp(0.5 * (before - after) / bend, -1.0, 1.0) : 0;  // a parabola's vertex
  return Turn{(best + beside) * kBin, at, at_zero};
}

/// Mean difference of the ranges, in kOtherSurface, if this profile has turned by `bins`. Uses one
/// range of `stride`.
double AzimuthProfile::residual(const AzimuthProfile& earlier, int bins, std::size_t stride) const {
  double sum = 0;
  for (std::size_t i = 0; i < seen_.size(); i += stride) {
    const std::uint32_t here = seen_[i];
    const auto bin = static_cast<int>(here % kBins);
    const std::size_t there = here - here % kBins + static_cast<std::uint32_t>((bin - bins + kBins) % kBins);
    const float range = there < earlier.ranges_.size() ? earlier.ranges_[there] : 0;
    sum += static_cast<double>(range == 0 ? kOtherSurface : std::min(std::abs(range - ranges_[here]), kOtherSurface));
  }
  return sum / static_cast<double>((size() + stride - 1) / stride);
}

}  // namespace curbstone::mapper::mounting
