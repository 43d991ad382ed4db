#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace curbstone::detect {

/// The median of each coordinate over the finite points; empty if there are none.
[[nodiscard]] std::optional<Eigen::Vector3d> middle_of(std::span<const Eigen::Vector3f> cloud);

/// Whether z seems to point down. Most points of a street lie low, on the ground. True if the lower half of the points
/// spreads over more than 2 m and over three times the height of the upper half.
[[nodiscard]] bool seems_upside_down(std::span<const Eigen::Vector3f> cloud);

}  // namespace curbstone::detect
