#include "tools/simulate/recorded/scan_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

#include "tools/simulate/recorded/file_bytes.hpp"
#include "tools/simulate/recorded/scan_rings.hpp"

namespace curbstone::simulate::recorded {

ScanFile read_scan_file(const std::string& file) {
  const std::string bytes = file_bytes(file);
  constexpr std::size_t kRecord = 4 * sizeof(float);
  if (bytes.size() % kRecord != 0)
    throw std::runtime_error(fmt::format("{}: no scan of float32 x y z intensity", file));
  std::vector<std::array<float, 4>> records(bytes.size() / kRecord);
  std::memcpy(records.data(), bytes.data(), bytes.size());
  // KITTI's intensity is 0..1 as published, and 0..255 in some conversions.
  const bool unit = std::all_of(records.begin(), records.end(), [](const auto& r) { return !(r[3] > 1.0F); });
  ScanFile scan;
  scan.positions.reserve(records.size());
  scan.intensities.reserve(records.size());
  for (const auto& r : records) {
    scan.positions.emplace_back(r[0], r[1], r[2]);
    const float intensity = unit ? r[3] * 255.0F : r[3];
    scan.intensities.push_back(static_cast<std::uint8_t>(intensity > 0 ? std::min(intensity, 255.0F) : 0.0F));
  }
  scan.rings = rings_of(scan.positions, file);
  return scan;
}

}  // namespace curbstone::simulate::recorded
