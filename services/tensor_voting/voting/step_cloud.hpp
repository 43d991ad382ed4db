#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace curbstone::tensor_voting::voting {

/// A position in whole steps.
struct WidePoint {
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t z = 0;
};

/// A cloud with arbitrary coordinates, in m, converted to steps relative to an origin in the cloud's middle. The steps
/// are as fine as a float resolves at the distances of a scale. Differences are exact, and coordinates of 1e6 m lose no
/// precision.
struct StepCloud {
  double step = 0;                                   ///< m: kStepsPerUnit steps make a unit
  double unit = 0;                                   ///< m: the power of two in (sigma / 2, sigma]
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< m
  std::vector<WidePoint> points;                     ///< the usable points
  std::vector<std::uint32_t> source;                 ///< index of each in the cloud
  std::size_t not_finite = 0;                        ///< skipped
  std::size_t too_far = 0;                           ///< skipped: kMaxUnits from the origin or more
};
inline constexpr std::int32_t kStepsPerUnit = 1 << 20;
inline constexpr double kMaxUnits = 1 << 19;  ///< 131 km at sigma 0.3
/// Converts a cloud; reuses the memory of `room`.
[[nodiscard]] StepCloud to_steps(std::span<const Eigen::Vector3d> points, double sigma, StepCloud room = {});

}  // namespace curbstone::tensor_voting::voting
