#include "tools/lidar_tool/points.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>
#include <ostream>
#include <stdexcept>
#include <vector>

#include "common/pcd/pcd_header.hpp"
#include "tools/lidar_tool/devices.hpp"
#include "tools/lidar_tool/sensor.hpp"

namespace curbstone::lidar_tool {

namespace {

void for_each_message(const Packets& packets, const PointSource& source, const Sensor::OnPoints& on_points) {
  Sensor sensor(source.model, on_points);
  const auto mine = [&](const Packets::Handler& handler) {
    packets.for_each([&](const Packet& packet) {
      if (packet.sender == source.address) handler(packet);
    });
  };
  mine([&](const Packet& packet) { sensor.prepare(packet); });
  sensor.finish_preparing();
  mine([&](const Packet& packet) { sensor.on_packet(packet); });
  sensor.finish();
}

/// A point of the PCD file.
struct PcdPoint {
  float x, y, z;
  std::uint32_t intensity, ring;
  float t;
};
static_assert(sizeof(PcdPoint) == 24);

}  // namespace

PointSource point_source(const Packets& packets, const std::string& address, const std::string& model) {
  std::optional<lidar::models::ModelName> wanted;
  if (!model.empty()) {
    wanted = model_named(model);
    if (!wanted) throw std::runtime_error(fmt::format("--model {}: there is no such model", model));
  }
  const std::vector<Device> devices = devices_in(packets);
  for (const Device& device : devices) {
    if (!address.empty() && device.address != lidar::sources::parse_ipv4(address, "--device")) continue;
    const auto of = wanted ? wanted : device.model;
    if (of) return {device.address, *of};
  }
  throw std::runtime_error(address.empty()
                               ? "no LiDAR that this program reads is in it: 'curbstone lidar info' says more"
                               : fmt::format("no LiDAR with the address {} is in it", address));
}

std::int64_t write_csv(const Packets& packets, const PointSource& source, std::ostream& out) {
  std::int64_t count = 0;
  fmt::print(out, "utime,revolution,x,y,z,intensity,ring\n");
  for_each_message(packets, source, [&](const lidar_points_t& m) {
    for (std::size_t i = 0; i < m.x.size(); ++i, ++count) {
      const std::int64_t utime = m.utime + std::llround(static_cast<double>(m.time_offset[i]) * 1e6);
      fmt::print(out, "{},{},{:.4f},{:.4f},{:.4f},{},{}\n", utime, m.revolution, m.x[i], m.y[i], m.z[i], m.intensity[i],
                 m.ring[i]);
    }
  });
  if (count == 0)
    throw std::runtime_error("no points: 'curbstone lidar info' says why; or is --model another device's?");
  return count;
}

std::int64_t write_pcd(const Packets& packets, const PointSource& source, std::int32_t revolution, std::ostream& out) {
  std::vector<PcdPoint> points;
  std::optional<std::int64_t> begin;
  std::int32_t last = -1;
  for_each_message(packets, source, [&](const lidar_points_t& m) {
    last = m.revolution;
    if (m.revolution != revolution) return;
    if (!begin) begin = m.utime;
    const double late = static_cast<double>(m.utime - *begin) * 1e-6;
    for (std::size_t i = 0; i < m.x.size(); ++i)
      points.push_back({m.x[i], m.y[i], m.z[i], m.intensity[i], m.ring[i],
                        static_cast<float>(late + static_cast<double>(m.time_offset[i]))});
  });
  if (points.empty())
    throw std::runtime_error(last < 0 ? "no points at all"
                                      : fmt::format("no points in revolution {}: there are 0 to {}", revolution, last));
  constexpr PcdField kFields[] = {{"x"}, {"y"}, {"z"}, {"intensity", 'U'}, {"ring", 'U'}, {"t"}};
  out << pcd_header(kFields, points.size());
  out.write(reinterpret_cast<const char*>(points.data()),
            static_cast<std::streamsize>(points.size() * sizeof(PcdPoint)));
  return static_cast<std::int64_t>(points.size());
}

}  // namespace curbstone::lidar_tool
