#include "common/pcd/pcd_header.hpp"

#include <fmt/format.h>

#include <bit>

namespace curbstone {

static_assert(std::endian::native == std::endian::little, "PCD's binary data is little-endian");

std::string pcd_header(std::span<const PcdField> fields, std::size_t points, const Pose& viewpoint) {
  std::string names, sizes, types, counts;
  for (const PcdField& field : fields) {
    names.append(" ").append(field.name);
    sizes += " 4";
    types += {' ', field.type};
    counts += " 1";
  }
  const Eigen::Vector3d p = viewpoint.translation();
  const Eigen::Quaterniond q(viewpoint.linear());
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS{}\nSIZE{}\nTYPE{}\nCOUNT{}\nWIDTH {}\n"
      "HEIGHT 1\nVIEWPOINT {} {} {} {} {} {} {}\nPOINTS {}\nDATA binary\n",
      names, sizes, types, counts, points, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), points);
}

}  // namespace curbstone
