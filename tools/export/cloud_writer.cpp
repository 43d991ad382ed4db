#include "tools/export/cloud_writer.hpp"

#include <fmt/format.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/ply_io.h>

#include <array>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "common/pcd/pcd_header.hpp"

namespace curbstone::map_export {

namespace {

pcl::PCLPointCloud2 to_pcl(const DenseCloud& cloud) {
  pcl::PCLPointCloud2 blob;
  blob.height = 1;
  blob.width = static_cast<std::uint32_t>(cloud.points.size());
  blob.point_step = 4 * sizeof(float);
  blob.row_step = blob.point_step * blob.width;
  blob.is_dense = 1;
  for (const char* name : {"x", "y", "z", "intensity"}) {
    pcl::PCLPointField field;
    field.name = name;
    field.offset = static_cast<std::uint32_t>(blob.fields.size() * sizeof(float));
    field.datatype = pcl::PCLPointField::FLOAT32;
    field.count = 1;
    blob.fields.push_back(field);
  }
  blob.data.resize(cloud.points.size() * blob.point_step);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const CloudPoint& p = cloud.points[i];
    const float row[4] = {p.position.x(), p.position.y(), p.position.z(), p.intensity};
    std::memcpy(&blob.data[i * blob.point_step], row, sizeof row);
  }
  return blob;
}

void write_pcd(const DenseCloud& cloud, const std::string& path) {
  constexpr std::array<PcdField, 4> kFields = {{{"x"}, {"y"}, {"z"}, {"intensity"}}};
  std::ofstream out(path, std::ios::binary);
  out << pcd_header(kFields, cloud.points.size());
  for (const CloudPoint& p : cloud.points) {
    const std::array<float, 4> row = {p.position.x(), p.position.y(), p.position.z(), p.intensity};
    out.write(reinterpret_cast<const char*>(row.data()), sizeof row);
  }
  out.flush();
  if (!out) throw std::runtime_error(fmt::format("{}: the cloud cannot be written", path));
}

void write_ply(const DenseCloud& cloud, const std::string& path) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // it prints errors; this function throws instead
  int result = -1;
  std::string why;
  try {
    result = pcl::PLYWriter().writeBinary(path, to_pcl(cloud), Eigen::Vector4f::Zero(), Eigen::Quaternionf::Identity(),
                                          false);
  } catch (const std::exception& error) {
    why = std::string(": ") + error.what();
  }
  if (result < 0) throw std::runtime_error(fmt::format("{}: the cloud cannot be written{}", path, why));
}

}  // namespace

void write_cloud(const DenseCloud& cloud, CloudFormat format, const std::string& path) {
  if (format == CloudFormat::kPcd) {
    write_pcd(cloud, path);
  } else {
    write_ply(cloud, path);
  }
}

}  // namespace curbstone::map_export
