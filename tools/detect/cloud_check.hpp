#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace curbstone::detect {

/// The median of each coordinate of the points that are finite; nothing if none is.
[[nodiscard]] std::optional<Eigen::Vector3d> middle_of(std::span<const Eigen::Vector3f> cloud);

/// Whether z seems to point down: of a street most points lie low, on the ground, and few high. True if the lower half
/// of the points spreads over more than 2 m and over three times the height of the upper half.
[[nodiscard]] bool seems_upside_down(std::span<const Eigen::Vector3f> cloud);

}  // namespace curbstone::detect
