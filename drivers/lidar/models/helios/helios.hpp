#pragma once

#include <array>
#include <cstddef>

#include "drivers/lidar/models/base/model.hpp"

namespace curbstone::lidar::models::helios {

/// Constants of RoboSense's Helios family: one packet layout, with 16 or 32 lasers. Source: RS-Helios-16P user manual;
/// rs_driver 4eeadace; nebula 606ac41.
inline constexpr std::size_t kRecords = 32;  ///< per block
inline constexpr std::size_t kBlocksPerPacket = 12;
inline constexpr double kSequencePeriod = 55.56e-6;  ///< s: each laser once
inline constexpr double kLensOffset = 0.03498;       ///< m

/// A model of the family.
struct Variant {
  ModelTable table;
  std::size_t lasers = 0;
  std::array<double, kRecords> times{};  ///< s after the sequence's first shot, by laser
};
extern const Variant k16p;
extern const Variant k32;

}  // namespace curbstone::lidar::models::helios
