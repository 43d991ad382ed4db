#include "services/relay/frame.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace curbstone::relay {
namespace {

std::vector<std::uint8_t> datagram(const std::string& message) {
  const auto header = encode_frame_header(0x0102030405060708, 0x090A0B0C);
  std::vector<std::uint8_t> bytes(header.begin(), header.end());
  bytes.insert(bytes.end(), message.begin(), message.end());
  return bytes;
}

TEST(RelayFrame, HasTheseBytes) {
  const std::vector<std::uint8_t> expected = {'C', 'B', 'R', '1', 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  EXPECT_EQ(datagram(""), expected);
}

TEST(RelayFrame, GivesBackRunNumberChannelAndData) {
  const auto bytes = datagram(std::string("IMU\0ab", 6));
  const auto frame = decode_frame(bytes);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->run, 0x0102030405060708U);
  EXPECT_EQ(frame->number, 0x090A0B0CU);
  EXPECT_EQ(frame->channel, "IMU");
  EXPECT_EQ(std::string(frame->data.begin(), frame->data.end()), "ab");
}

TEST(RelayFrame, WithoutAMessageIsASignOfLife) {
  const auto bytes = datagram("");
  const auto frame = decode_frame(bytes);
  ASSERT_TRUE(frame);
  EXPECT_TRUE(frame->channel.empty());
}

TEST(RelayFrame, RefusesWhatIsNone) {
  auto other_magic = datagram(std::string("IMU\0", 4));
  other_magic[3] = '2';
  EXPECT_FALSE(decode_frame(other_magic));
  EXPECT_FALSE(decode_frame(std::vector<std::uint8_t>(15, 'C'))) << "cut off";
  EXPECT_FALSE(decode_frame({}));
  EXPECT_FALSE(decode_frame(datagram("IMU"))) << "a channel without its end";
  EXPECT_FALSE(decode_frame(datagram(std::string("\0data", 5)))) << "a channel without a name";
  EXPECT_FALSE(decode_frame(datagram(std::string(64, 'c') + '\0')));
  EXPECT_TRUE(decode_frame(datagram(std::string(63, 'c') + '\0')));
}

}  // namespace
}  // namespace curbstone::relay
