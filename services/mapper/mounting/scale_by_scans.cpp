#include "services/mapper/mounting/scale_by_scans.hpp"

#include <array>
#include <cmath>

#include "common/statistics/consistent_median.hpp"
#include "services/mapper/mounting/lowest.hpp"

namespace curbstone::mapper::mounting {
namespace {

constexpr int kSteps = 8;                                   // scales on each side of 1
constexpr double kStep = ScaleByScans::kMaxError / kSteps;  // from one scale to the next
constexpr double kOtherThings = 0.7;                        // residual beyond which the scans show different things
constexpr std::size_t kMinMeasured = 3;                     // comparisons
constexpr double kMaxSpread = 0.015;                        // of the scale: half of the middle half of the comparisons
constexpr double kHealed = 0.5;                             // of an error, below which nothing is corrected any more

}  // namespace

void ScaleByScans::add(std::int64_t utime, const std::vector<scan::LidarPoint>& points, const Pose& T_map_base,
                       const Pose& T_odom_base) {
  if (reference_ && utime > reference_->utime && utime - reference_->utime <= kMaxAge) {
    Pose T_reference_base = reference_->T_odom_base.inverse() * T_odom_base;
    if (T_reference_base.translation().norm() < kBaseline) return;
    T_reference_base.linear() = reference_->T_map_base.linear().transpose() * T_map_base.linear();
    if (const auto measured = measure(points, T_reference_base)) conclude(*measured);
  }
  reference_.emplace(Reference{utime, T_map_base, T_odom_base, {points, Pose::Identity(), lidar_}});
}

/// The scale with the least residual.
std::optional<double> ScaleByScans::measure(const std::vector<scan::LidarPoint>& points,
                                            const Pose& T_reference_base) const {
  const UprightPoints upright(points, lidar_);
  std::array<double, 2 * kSteps + 1> residuals{};
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    Pose T_scaled = T_reference_base;
    T_scaled.translation() *= 1 + (static_cast<double>(i) - kSteps) * kStep;
    const auto residual = AzimuthProfile(upright, T_scaled).residual_to(reference_->profile);
    if (!residual) return std::nullopt;
    residuals[i] = *residual;
  }
  const auto least = lowest(residuals, kOtherThings);
  if (!least) return std::nullopt;
  return 1 + (*least - kSteps) * kStep;
}

void ScaleByScans::conclude(double measured) {
  measured_.push_back(measured);
  if (measured_.size() > kWindow) measured_.pop_front();
  const auto median = consistent_median({measured_.begin(), measured_.end()}, kMaxSpread, kMinMeasured);
  if (!median) return;
  const double error = *median - 1;
  const double limit = (error > 0 ? kMinShort : kMinLong) * (scale_ == 1 ? 1 : kHealed);
  scale_ = std::abs(error) > limit ? *median : 1;
}

}  // namespace curbstone::mapper::mounting
