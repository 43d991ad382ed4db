#pragma once

#include <cstdint>
#include <span>

#include "drivers/lidar/decoding/point_writer.hpp"

namespace curbstone::lidar::decoding {

inline constexpr std::size_t kRecordBytes = 3;  ///< distance, big-endian, and intensity

/// Decodes the records of a data block in RoboSense's layout. Sets `records.repeats` to 0.
void take_records(std::span<const std::uint8_t, kRecordBytes * kRecordsPerBlock> bytes, BlockRecords& records);

}  // namespace curbstone::lidar::decoding
