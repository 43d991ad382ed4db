#include "tools/export/cloud_writer.hpp"

#include <fmt/format.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include <cstring>
#include <stdexcept>

namespace curbstone {

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

}  // namespace

void write_cloud(const DenseCloud& cloud, CloudFormat format, const std::string& path) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // it prints; we throw
  const pcl::PCLPointCloud2 blob = to_pcl(cloud);
  const Eigen::Vector4f origin = Eigen::Vector4f::Zero();
  const Eigen::Quaternionf upright = Eigen::Quaternionf::Identity();
  int result = -1;
  std::string why;
  try {
    result = format == CloudFormat::kPcd ? pcl::PCDWriter().writeBinary(path, blob, origin, upright)
                                         : pcl::PLYWriter().writeBinary(path, blob, origin, upright, false);
  } catch (const std::exception& error) {
    why = std::string(": ") + error.what();
  }
  if (result < 0) throw std::runtime_error(fmt::format("{}: the cloud cannot be written{}", path, why));
}

}  // namespace curbstone
