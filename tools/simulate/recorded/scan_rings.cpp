#include "tools/simulate/recorded/scan_rings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <stdexcept>

#include "tools/simulate/recorded/file_bytes.hpp"

namespace curbstone::simulate::recorded {

namespace {

std::vector<std::uint8_t> ring_file(const std::string& scan_file, std::size_t points) {
  namespace fs = std::filesystem;
  const fs::path scan = scan_file;
  const fs::path folder = scan.parent_path();
  for (const fs::path& rings : {folder.parent_path() / "rings", folder / "rings"}) {
    const fs::path file = rings / scan.filename();
    if (!fs::exists(file)) continue;
    const std::string bytes = file_bytes(file.string());
    if (bytes.size() != points)
      throw std::runtime_error(fmt::format("{}: {} rings for {} points", file.string(), bytes.size(), points));
    std::vector<std::uint8_t> from_top(bytes.begin(), bytes.end());
    const std::uint8_t bottom =
        from_top.empty() ? std::uint8_t{0} : *std::max_element(from_top.begin(), from_top.end());
    for (std::uint8_t& ring : from_top) ring = static_cast<std::uint8_t>(bottom - ring);
    return from_top;
  }
  return {};
}

std::vector<std::uint8_t> rings_by_order(const std::vector<Eigen::Vector3f>& points) {
  std::vector<std::uint8_t> rings;
  int ring = 0;
  float before = 0;
  for (const Eigen::Vector3f& p : points) {
    float turn = std::atan2(p.y(), p.x());
    if (turn < 0) turn += 2 * std::numbers::pi_v<float>;
    if (turn < before - std::numbers::pi_v<float>) ++ring;
    if (ring > 127) return {};
    before = turn;
    rings.push_back(static_cast<std::uint8_t>(ring));
  }
  if (ring < 3) return {};
  for (std::uint8_t& r : rings) r = static_cast<std::uint8_t>(ring - r);
  return rings;
}

std::vector<std::uint8_t> rings_by_elevation(const std::vector<Eigen::Vector3f>& points) {
  std::vector<std::uint8_t> rings;
  for (const Eigen::Vector3f& p : points) {
    const float elevation = std::atan2(p.z(), p.head<2>().norm()) * 180 / std::numbers::pi_v<float>;
    rings.push_back(static_cast<std::uint8_t>(std::clamp(std::lround((elevation + 40) * 2), 0L, 255L)));
  }
  return rings;
}

}  // namespace

std::vector<std::uint8_t> rings_of(const std::vector<Eigen::Vector3f>& points, const std::string& scan_file) {
  std::vector<std::uint8_t> rings = ring_file(scan_file, points.size());
  if (rings.empty()) rings = rings_by_order(points);
  return rings.empty() ? rings_by_elevation(points) : rings;
}

}  // namespace curbstone::simulate::recorded
