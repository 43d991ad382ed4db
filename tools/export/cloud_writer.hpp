#pragma once

#include <string>

#include "tools/export/dense_cloud.hpp"

namespace curbstone::map_export {

enum class CloudFormat { kPcd, kPly };

/// Binary, x y z intensity as float32 (at 1 km from the origin that is 0.03 mm), PLY through PCL. Throws
/// std::runtime_error.
void write_cloud(const DenseCloud& cloud, CloudFormat format, const std::string& path);

}  // namespace curbstone::map_export
