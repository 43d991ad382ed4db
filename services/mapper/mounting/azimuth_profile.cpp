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

/// The bin of a direction. The arctangent is a polynomial, accurate to 1e-4 rad, without branches, because they would
/// be mispredicted.
int bin_of(float px, float py) {
  const float x = std::abs(px);
  const float y = std::abs(py);
  const float less = x < y ? x : y;
  const float more = x < y ? y : x;
  const float ratio = less / (more < 1e-6F ? 1e-6F : more);
  const float square = ratio * ratio;
  const float octant = ratio * (0.99921F + square * (-0.32117F + square * (0.14627F - square * 0.03899F)));
  const float beyond_octant = std::numbers::pi_v<float> / 2 - octant;
  const float quadrant = y > x ? beyond_octant : octant;
  const float beyond_quadrant = std::numbers::pi_v<float> - quadrant;
  const float half = px < 0 ? beyond_quadrant : quadrant;
  const float beyond_half = 2 * std::numbers::pi_v<float> - half;
  const float angle = py < 0 ? beyond_half : half;
  const int bin = static_cast<int>(angle / static_cast<float>(AzimuthProfile::kBin));
  return bin < AzimuthProfile::kBins - 1 ? bin : AzimuthProfile::kBins - 1;
}

}  // namespace

/// With one branch only, because branches on heights are mispredicted.
UprightPoints::UprightPoints(const std::vector<scan::LidarPoint>& points, const Eigen::Vector3d& lidar)
    : lidar_(lidar), ring_(points.size() + 1) {
  const auto most = static_cast<Eigen::Index>(points.size()) + 1;  // one more, which the next one overwrites
  x_.resize(most), y_.resize(most);
  const Eigen::Vector2f from = lidar.head<2>().cast<float>();
  Eigen::Index size = 0;
  for (const scan::LidarPoint& point : points) {
    const Eigen::Vector3f& p = point.position;
    if (!(p.z() > kUpright)) continue;
    const float dx = p.x() - from.x(), dy = p.y() - from.y();
    const float away = std::sqrt(dx * dx + dy * dy);
    x_[size] = p.x();
    y_[size] = p.y();
    ring_[static_cast<std::size_t>(size)] = point.ring;
    size += static_cast<int>(p.z() > kUpright + kSlope * away) & static_cast<int>(away > kNear) &
            static_cast<int>(away < kFar);
  }
  x_.conservativeResize(size), y_.conservativeResize(size);
}

AzimuthProfile::AzimuthProfile(const UprightPoints& points, const Pose& T_there_base) {
  const Eigen::Matrix2f R = T_there_base.linear().topLeftCorner<2, 2>().cast<float>();
  const Eigen::Vector2f t = (T_there_base.translation() - points.lidar_).head<2>().cast<float>();
  // Roots are taken one by one: those of Eigen's arrays are not exact.
  const Eigen::ArrayXf x = R(0, 0) * points.x_ + R(0, 1) * points.y_ + t.x();
  const Eigen::ArrayXf y = R(1, 0) * points.x_ + R(1, 1) * points.y_ + t.y();
  const Eigen::ArrayXf ranges2 = x.square() + y.square();
  Eigen::ArrayXi bins(x.size());
  std::transform(x.data(), x.data() + x.size(), y.data(), bins.data(), bin_of);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const std::size_t row = static_cast<std::size_t>(points.ring_[static_cast<std::size_t>(i)]) * kBins;
    if (ranges_.size() < row + kBins) ranges_.resize(row + kBins);
    const std::size_t at = row + static_cast<std::size_t>(bins[i]);
    float& range = ranges_[at];
    const float r = std::sqrt(ranges2[i]);
    if (range == 0) seen_.push_back(static_cast<std::uint32_t>(at));
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
