#include <gtest/gtest.h>

#include <array>

#include "common/bytes/big_endian.hpp"
#include "common/bytes/little_endian.hpp"

namespace curbstone {
namespace {

constexpr std::array<std::uint8_t, 8> kBytes = {0x81, 0x02, 0x03, 0x84, 0x05, 0x06, 0x07, 0x88};

TEST(BigEndian, ReadsTheMostSignificantByteFirst) {
  EXPECT_EQ(read_big_endian<std::uint8_t>(kBytes), 0x81);
  EXPECT_EQ(read_big_endian<std::uint16_t>(kBytes), 0x8102);
  EXPECT_EQ(read_big_endian<std::uint32_t>(kBytes), 0x81020384);
  EXPECT_EQ(read_big_endian<std::uint64_t>(kBytes), 0x8102038405060788);
}

TEST(BigEndian, AppendsWhatItReads) {
  std::vector<std::uint8_t> bytes = {1};
  append_big_endian(bytes, std::uint32_t{0x81020384});
  EXPECT_EQ(bytes, (std::vector<std::uint8_t>{1, 0x81, 0x02, 0x03, 0x84}));
}

TEST(BigEndian, FieldOfAPacketStandsForItsNumber) {
  static_assert(sizeof(Be16) == 2 && sizeof(Be24) == 3 && alignof(Be24) == 1);
  Be24 field = 0x810203;
  EXPECT_EQ(field.bytes[0], 0x81);
  EXPECT_EQ(field.bytes[2], 0x03);
  EXPECT_EQ(field, 0x810203U);
  field = 0xFF000001;
  EXPECT_EQ(field, 1U) << "what does not fit is cut off at the front";
  EXPECT_EQ(Be16{}, 0);
}

TEST(LittleEndian, ReadsAndWritesTheLeastSignificantByteFirst) {
  EXPECT_EQ(read_little_endian<std::uint16_t>(kBytes), 0x0281);
  EXPECT_EQ(read_little_endian<std::uint32_t>(kBytes), 0x84030281);
  std::array<std::uint8_t, 5> bytes = {9, 9, 9, 9, 9};
  write_little_endian(bytes, std::uint32_t{0x84030281});
  EXPECT_EQ(bytes, (std::array<std::uint8_t, 5>{0x81, 0x02, 0x03, 0x84, 9}));
}

}  // namespace
}  // namespace curbstone
