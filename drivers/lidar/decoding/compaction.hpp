#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace curbstone::lidar::decoding {

/// A four-byte field of each record, as an array: its source, and the destination of the kept values, in order.
struct Column {
  const void* from = nullptr;
  void* to = nullptr;  ///< with room for all records and kCompactionSlack
};
inline constexpr std::size_t kCompactionSlack = 8;  ///< values that may be written after the kept ones

/// Copies the kept values of `keep.size()` records to the columns' destinations; returns their number. `keep`: 1 or 0
/// per record. The number of records is a multiple of eight. No branch depends on `keep`, because which shots have a
/// return is practically random.
std::size_t compact(std::span<const std::uint8_t> keep, std::span<const Column> columns);

}  // namespace curbstone::lidar::decoding
