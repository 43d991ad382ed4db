#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>

#include "drivers/lidar/models/make_model.hpp"
#include "tools/lidar_tool/packets.hpp"

namespace curbstone::lidar_tool {

/// The device and model whose points are used.
struct PointSource {
  lidar::sources::Ipv4 address = 0;
  lidar::models::ModelName model = lidar::models::ModelName::kRs16;
};

/// The device with the most packets, restricted to this address and this model if given. Throws std::runtime_error with
/// a one-line message if there is none.
[[nodiscard]] PointSource point_source(const Packets& packets, const std::string& address, const std::string& model);

/// Writes the points as CSV with a heading: utime (us since the Unix epoch, of each shot), revolution, x, y, z (m, in
/// the lidar frame), intensity, ring. Returns their number. Throws std::runtime_error, one line, where there is none.
std::int64_t write_csv(const Packets& packets, const PointSource& source, std::ostream& out);

/// Writes the points of one revolution, counted from 0, as a binary PCD: x, y, z (m), intensity, ring, t (s after the
/// first shot). Returns their number. Throws std::runtime_error with a one-line message if there is no such revolution.
std::int64_t write_pcd(const Packets& packets, const PointSource& source, std::int32_t revolution, std::ostream& out);

}  // namespace curbstone::lidar_tool
