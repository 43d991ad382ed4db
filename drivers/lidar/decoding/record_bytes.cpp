#include "drivers/lidar/decoding/record_bytes.hpp"

#include <bit>
#include <cstring>

#include "drivers/lidar/decoding/vector_width.hpp"

namespace curbstone::lidar::decoding {

#if defined(__GNUC__) && !defined(__clang__)
namespace {
using Sixteen = std::uint8_t __attribute__((vector_size(16)));
}  // namespace

/// Decodes eight records at a time: 24 bytes, in two overlapping vectors (the second begins at byte 8).
CURBSTONE_FOR_EACH_VECTOR_WIDTH
void take_records(std::span<const std::uint8_t, kRecordBytes * kRecordsPerBlock> bytes, BlockRecords& records) {
  static_assert(std::endian::native == std::endian::little);
  constexpr Sixteen kDistances = {1, 0, 4, 3, 7, 6, 10, 9, 13, 12, 24, 23, 27, 26, 30, 29};
  constexpr Sixteen kIntensities = {2, 5, 8, 11, 14, 25, 28, 31, 2, 5, 8, 11, 14, 25, 28, 31};
  constexpr std::size_t kAtOnce = 8;
  for (std::size_t i = 0; i < kRecordsPerBlock; i += kAtOnce) {
    Sixteen front, back;
    std::memcpy(&front, &bytes[kRecordBytes * i], sizeof front);
    std::memcpy(&back, &bytes[kRecordBytes * i + 8], sizeof back);
    const Sixteen distances = __builtin_shuffle(front, back, kDistances);
    const Sixteen intensities = __builtin_shuffle(front, back, kIntensities);
    std::memcpy(&records.distance[i], &distances, sizeof distances);
    std::memcpy(&records.intensity[i], &intensities, kAtOnce);
  }
  records.repeats = 0;
}
#else
void take_records(std::span<const std::uint8_t, kRecordBytes * kRecordsPerBlock> bytes, BlockRecords& records) {
  for (std::size_t i = 0; i < kRecordsPerBlock; ++i) {
    const std::uint8_t* record = &bytes[kRecordBytes * i];
    records.distance[i] = static_cast<std::uint16_t>(record[0] << 8 | record[1]);
    records.intensity[i] = record[2];
  }
  records.repeats = 0;
}
#endif

}  // namespace curbstone::lidar::decoding
