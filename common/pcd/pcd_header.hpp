#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "common/geometry/geometry.hpp"

namespace curbstone {

/// A numeric field of each point, four bytes wide.
struct PcdField {
  std::string_view name;
  char type = 'F';  ///< F: float, U: unsigned, I: signed
};

/// The header of a binary PCD 0.7 file (pointclouds.org, "The PCD file format"), which PCL, pcl_viewer and CloudCompare
/// open. The points follow it, each with its fields in this order, little-endian.
[[nodiscard]] std::string pcd_header(std::span<const PcdField> fields, std::size_t points,
                                     const Pose& viewpoint = Pose::Identity());

}  // namespace curbstone
