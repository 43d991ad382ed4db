#pragma once

#include <string>

#include "tools/export/dense_cloud.hpp"

namespace curbstone::map_export {

enum class CloudFormat { kPcd, kPly };

/// Writes a binary file with x y z intensity as float32 (resolution 0.03 mm at 1 km from the origin). Throws
/// std::runtime_error, also if not all of it is written.
void write_cloud(const DenseCloud& cloud, CloudFormat format, const std::string& path);

}  // namespace curbstone::map_export
