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

/// A cloud of any coordinates, in m, in steps as fine as a float can tell at the distances of a scale, from an origin
/// in the cloud's middle: differences are exact, and coordinates of 1e6 m lose nothing.
struct StepCloud {
  double step = 0;                                   ///< m: kStepsPerUnit make a unit
  double unit = 0;                                   ///< m: the power of two in (sigma / 2, sigma]
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< m
  std::vector<WidePoint> points;                     ///< those that could be used
  std::vector<std::uint32_t> source;                 ///< the index of each in the cloud
  std::size_t not_finite = 0;                        ///< skipped
  std::size_t too_far = 0;                           ///< skipped: kMostUnits from the origin or more
};
inline constexpr std::int32_t kStepsPerUnit = 1 << 20;
inline constexpr double kMostUnits = 1 << 19;  ///< 131 km at sigma 0.3
/// In the memory of `room`.
[[nodiscard]] StepCloud to_steps(std::span<const Eigen::Vector3d> points, double sigma, StepCloud room = {});

}  // namespace curbstone::tensor_voting::voting
