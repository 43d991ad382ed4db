#include "services/mapper/mounting/yaw_at_start.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "common/statistics/consistent_median.hpp"
#include "services/mapper/mounting/lowest.hpp"

namespace curbstone::mapper::mounting {
namespace {

constexpr int kCoarse = 36;  // directions all around
constexpr double kCoarseStep = 2 * std::numbers::pi / kCoarse;
constexpr int kFine = 8;  // on each side of the best of those
constexpr double kFineStep = kCoarseStep / kFine;
constexpr double kOtherScene = 0.7;     // residual beyond which the scans show different things
constexpr double kMaxYawSpread = 0.01;  // rad, half of the middle half of the pairs
constexpr std::size_t kKept = 5;        // pairs

}  // namespace

std::optional<double> YawAtStart::add(std::int64_t utime, const std::vector<scan::LidarPoint>& points,
                                      const Pose& T_odom_base) {
  if (is_over_) return std::nullopt;
  if (reference_ && utime > reference_->utime && utime - reference_->utime <= kMaxPairAge) {
    const Pose T_reference_base = reference_->T_odom_base.inverse() * T_odom_base;
    const double way = T_reference_base.translation().norm();
    if (way < kBaseline) return std::nullopt;
    way_ += way;
    if (const auto yaw = measure(points, T_reference_base)) measured_.push_back(*yaw);
    if (measured_.size() > kKept) measured_.pop_front();
  }
  reference_.emplace(Reference{utime, T_odom_base, {points, Pose::Identity(), lidar_}});
  const auto yaw = consistent_median({measured_.begin(), measured_.end()}, kMaxYawSpread, kPairs);
  is_over_ = yaw || way_ > kMaxWay;
  if (!is_over_) return std::nullopt;
  reference_.reset();
  return yaw && std::abs(*yaw) > wrong_ ? yaw : std::nullopt;
}

/// Residual of the two scans if the LiDAR looks `yaw` to the left of what the file says: its points in base_link are
/// turned the other way about it, and so is its motion.
std::optional<double> YawAtStart::residual(const std::vector<scan::LidarPoint>& points, const Pose& T_reference_base,
                                           double yaw) const {
  Pose T_true_assumed = Pose::Identity();
  T_true_assumed.translate(lidar_).rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())).translate(-lidar_);
  const Pose T_assumed = T_true_assumed.inverse() * T_reference_base * T_true_assumed;
  return AzimuthProfile(points, T_assumed, lidar_).residual_to(reference_->profile);
}

/// The yaw with the least residual.
std::optional<double> YawAtStart::measure(const std::vector<scan::LidarPoint>& points,
                                          const Pose& T_reference_base) const {
  double best = 0, least = 1;
  for (int i = 0; i < kCoarse; ++i) {
    const double yaw = std::remainder(i * kCoarseStep, 2 * std::numbers::pi);
    const auto found = residual(points, T_reference_base, yaw);
    if (!found) return std::nullopt;
    if (*found >= least) continue;
    least = *found;
    best = yaw;
  }
  std::array<double, 2 * kFine + 1> residuals{};
  for (std::size_t i = 0; i < residuals.size(); ++i)
    residuals[i] = residual(points, T_reference_base, best + (static_cast<double>(i) - kFine) * kFineStep).value_or(1);
  const auto finest = lowest(residuals, kOtherScene);
  if (!finest) return std::nullopt;
  return std::remainder(best + (*finest - kFine) * kFineStep, 2 * std::numbers::pi);
}

}  // namespace curbstone::mapper::mounting
