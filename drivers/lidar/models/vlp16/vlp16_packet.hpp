#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/bytes/little_endian.hpp"

namespace curbstone::lidar::models::vlp16 {

/// Constants of the Velodyne VLP-16 (and the Puck LITE, which has the same angles): 16 lasers that fire one after
/// another; two of these sequences per block. Little-endian, except for the block's flag. Source: VLP-16 User Manual
/// 63-9243 Rev D, chapter 9.
inline constexpr int kLasers = 16;
inline constexpr int kRecordsPerBlock = 32;
inline constexpr int kBlocksPerPacket = 12;
inline constexpr double kLaserPeriod = 2.304e-6;      ///< s
inline constexpr double kSequencePeriod = 55.296e-6;  ///< s
inline constexpr double kBlockPeriod = 2 * kSequencePeriod;
inline constexpr double kDistanceStep = 0.002;  ///< m

inline constexpr std::size_t kPacketSize = 1206;
inline constexpr std::size_t kPositionSize = 512;
inline constexpr int kDataPort = 2368;
inline constexpr int kPositionPort = 8308;

inline constexpr std::size_t kBlockSize = 100;
inline constexpr std::size_t kStamp = 1200;       ///< u32, us past the hour
inline constexpr std::size_t kReturnMode = 1204;  ///< byte
inline constexpr std::uint8_t kStrongest = 0x37;
inline constexpr std::uint8_t kLast = 0x38;
inline constexpr std::uint8_t kDual = 0x39;

/// deg above the horizon, by laser in firing order (manual, table 9-1).
inline constexpr std::array<double, kLasers> kElevations = {-15, 1, -13, 3,  -11, 5,  -9, 7,
                                                            -7,  9, -5,  11, -3,  13, -1, 15};
/// m, height of each laser's beam origin above the device's origin.
inline constexpr std::array<double, kLasers> kHeights = {0.0112, -0.0007, 0.0097, -0.0022, 0.0081, -0.0037,
                                                         0.0066, -0.0051, 0.0051, -0.0066, 0.0037, -0.0081,
                                                         0.0022, -0.0097, 0.0007, -0.0112};

}  // namespace curbstone::lidar::models::vlp16
