#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace curbstone::lidar::decoding {

/// A figure of each of some records, of which some are to be kept: where they are, and where those that are kept go, in
/// order. Each is four bytes.
struct Column {
  const void* from = nullptr;
  void* to = nullptr;  ///< with room for all records and kCompactionSlack
};
inline constexpr std::size_t kCompactionSlack = 8;  ///< values that may be written after those that are kept

/// Moves what is kept of `records` records to the columns' ends; returns how many those are. `keep`: 1 or 0 a record.
/// `records` is a multiple of eight. No branch depends on `keep`: which shots have a return is as good as random.
std::size_t compact(std::span<const std::uint8_t> keep, std::span<const Column> columns);

}  // namespace curbstone::lidar::decoding
