#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

namespace curbstone::bench::voting {

/// Votes that a cloud casts: ordered pairs of points closer than `radius` (m), counted by comparing distances and
/// nothing else, so that a kernel's speed can be given in votes that matter and not in pairs that it looked at.
[[nodiscard]] std::int64_t count_pair_votes(std::span<const Eigen::Vector3d> points, double radius, int threads);

}  // namespace curbstone::bench::voting
