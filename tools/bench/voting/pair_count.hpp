#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

namespace curbstone::bench::voting {

/// Counts the votes of a cloud: ordered pairs of points closer than `radius` (m), by comparing distances only. So a
/// kernel's speed is stated in useful votes, not in pairs tested.
[[nodiscard]] std::int64_t count_pair_votes(std::span<const Eigen::Vector3d> points, double radius, int threads);

}  // namespace curbstone::bench::voting
