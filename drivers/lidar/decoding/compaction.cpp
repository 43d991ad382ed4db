#include "drivers/lidar/decoding/compaction.hpp"

#include <bit>
#include <cstring>

#include "drivers/lidar/decoding/vector_width.hpp"

namespace curbstone::lidar::decoding {

namespace {

constexpr std::size_t kEight = 8;
constexpr std::size_t kValue = 4;  // bytes
using Order = std::array<std::int32_t, kEight>;

/// For each set of kept values among eight (bit i: the i-th is kept): the indices of the first, the second, ... kept
/// one.
constexpr std::array<Order, 256> kOrders = [] {
  std::array<Order, 256> orders{};
  for (unsigned set = 0; set < 256; ++set) {
    std::size_t next = 0;
    for (unsigned i = 0; i < kEight; ++i) {
      if ((set >> i & 1) != 0) orders[set][next++] = static_cast<std::int32_t>(i);
    }
  }
  return orders;
}();

/// Converts eight bytes of 0 or 1 to a set: the product has bit 0 of byte i as bit 56 + i.
unsigned set_of(const std::uint8_t* keep) {
  static_assert(std::endian::native == std::endian::little);
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, keep, sizeof bytes);
  return static_cast<unsigned>(bytes * 0x0102040810204080U >> 56);
}

#if defined(__GNUC__) && !defined(__clang__)
using Eight = std::int32_t __attribute__((vector_size(kEight * kValue)));

inline void put_in_order(const void* from, const Order& order, void* to) {
  Eight values, indices;
  std::memcpy(&values, from, sizeof values);
  std::memcpy(&indices, order.data(), sizeof indices);
  values = __builtin_shuffle(values, indices);  // one instruction if vectors are this wide
  std::memcpy(to, &values, sizeof values);
}
#else
inline void put_in_order(const void* from, const Order& order, void* to) {
  std::array<std::int32_t, kEight> values, ordered;
  std::memcpy(values.data(), from, sizeof values);
  for (std::size_t i = 0; i < kEight; ++i) ordered[i] = values[static_cast<std::size_t>(order[i])];
  std::memcpy(to, ordered.data(), sizeof ordered);
}
#endif

}  // namespace

CURBSTONE_FOR_EACH_VECTOR_WIDTH
std::size_t compact(std::span<const std::uint8_t> keep, std::span<const Column> columns) {
  std::size_t count = 0;
  for (std::size_t first = 0; first < keep.size(); first += kEight) {
    const unsigned set = set_of(&keep[first]);
    for (const Column& column : columns)
      put_in_order(static_cast<const char*>(column.from) + kValue * first, kOrders[set],
                   static_cast<char*>(column.to) + kValue * count);
    count += static_cast<std::size_t>(std::popcount(set));
  }
  return count;
}

}  // namespace curbstone::lidar::decoding
