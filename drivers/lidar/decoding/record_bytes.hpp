#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>

#include "drivers/lidar/decoding/point_writer.hpp"

namespace curbstone::lidar::decoding {

inline constexpr std::size_t kRecordBytes = 3;  ///< distance, big-endian, and intensity

/// Decodes the records of a data block in RoboSense's layout. Sets `records.repeats` to 0.
void take_records(std::span<const std::uint8_t, kRecordBytes * kRecordsPerBlock> bytes, BlockRecords& records);

/// The same for the packed records of a packet's layout.
template <class Record>
[[nodiscard]] BlockRecords records_of(const Record (&packed)[kRecordsPerBlock]) {
  static_assert(sizeof(Record) == kRecordBytes);
  std::array<std::uint8_t, kRecordBytes * kRecordsPerBlock> bytes;
  std::memcpy(bytes.data(), packed, sizeof bytes);
  BlockRecords records;
  take_records(bytes, records);
  return records;
}

}  // namespace curbstone::lidar::decoding
