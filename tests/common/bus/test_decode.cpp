// What lcm-gen 1.3.1 believes of bytes off the wire, and ours must not (cmake/LcmTypes.cmake).
#include "common/bus/decode.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <curbstone/service_status_t.hpp>
#include <initializer_list>
#include <vector>

namespace curbstone {
namespace {

/// A status of a service "ekf" on host "a". Its first string begins behind fingerprint and stamp.
std::vector<std::uint8_t> status() {
  service_status_t message{};
  message.service = "ekf";
  message.host = "a";
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  (void)message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}
constexpr std::size_t kLength = 16, kText = 20;

bool decodes(const std::vector<std::uint8_t>& bytes) {
  service_status_t message{};
  return decode(bytes.data(), static_cast<int>(bytes.size()), message);
}

void put(std::vector<std::uint8_t>& bytes, std::size_t at, std::initializer_list<std::uint8_t> values) {
  std::copy(values.begin(), values.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

TEST(Decode, AMessageWithStringsIsTaken) {
  EXPECT_TRUE(decodes(status()));
}

TEST(Decode, AStringOfMinusTwoBillionBytesIsRefused) {
  auto bytes = status();
  put(bytes, kLength, {0x80, 0, 0, 0});  // minus one, as lcm-gen counts without the 0: 2 GiB to copy
  EXPECT_FALSE(decodes(bytes));
}

TEST(Decode, AStringWithoutEvenItsEndIsRefused) {
  auto bytes = status();
  put(bytes, kLength, {0, 0, 0, 0});
  EXPECT_FALSE(decodes(bytes));
  put(bytes, kLength, {0xFF, 0xFF, 0xFF, 0xFF});
  EXPECT_FALSE(decodes(bytes));
}

TEST(Decode, AStringIsRefusedThatDoesNotEndWhereItSays) {
  auto bytes = status();
  bytes[kText + 3] = '!';
  EXPECT_FALSE(decodes(bytes)) << "no 0 at its end";
  bytes = status();
  bytes[kText + 1] = 0;
  EXPECT_FALSE(decodes(bytes)) << "a 0 inside, which could not be sent on";
}

TEST(Decode, AnyCutIsRefused) {
  const auto bytes = status();
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(decodes({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)})) << size;
}

}  // namespace
}  // namespace curbstone
