#include "tools/export/cloud_writer.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <fstream>
#include <stdexcept>
#include <string>

#include "common/pcd/pcd_header.hpp"

namespace curbstone::map_export {

namespace {

static_assert(std::endian::native == std::endian::little, "both formats' binary data is little-endian here");

std::string ply_header(std::size_t points) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property float intensity\nend_header\n",
      points);
}

}  // namespace

void write_cloud(const DenseCloud& cloud, CloudFormat format, const std::string& path) {
  constexpr std::array<PcdField, 4> kFields = {{{"x"}, {"y"}, {"z"}, {"intensity"}}};
  std::ofstream out(path, std::ios::binary);
  out << (format == CloudFormat::kPcd ? pcd_header(kFields, cloud.points.size()) : ply_header(cloud.points.size()));
  for (const CloudPoint& p : cloud.points) {
    const std::array<float, 4> row = {p.position.x(), p.position.y(), p.position.z(), p.intensity};
    out.write(reinterpret_cast<const char*>(row.data()), sizeof row);
  }
  out.flush();
  if (!out) throw std::runtime_error(fmt::format("{}: the cloud cannot be written", path));
}

}  // namespace curbstone::map_export
