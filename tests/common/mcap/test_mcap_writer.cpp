#include "common/mcap/mcap_writer.hpp"

#include <gmock/gmock.h>

#include <sstream>

#include "tests/common/mcap/mcap_reader.hpp"

namespace curbstone {
namespace {

using test::McapFile;
using test::read_mcap;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// One JSON message {} of 7 ns, made by hand from the specification, checksums by Python's zlib.
constexpr std::string_view kOneMessage =
    "894d434150300d0a01090000000000000000000000010000004c068c0000000000000007000000000000000700000000"
    "00000064000000000000000c86ef13000000006400000000000000031b00000000000000010001000000530a0000006a"
    "736f6e736368656d61020000007b7d04160000000000000000000100020000002f74040000006a736f6e000000000518"
    "00000000000000000000000000070000000000000005000000000000007b7d0716000000000000000000100000000700"
    "00000000000043000000000000000f0400000000000000bc9b4562031b00000000000000010001000000530a0000006a"
    "736f6e736368656d61020000007b7d04160000000000000000000100020000002f74040000006a736f6e000000000b38"
    "000000000000000100000000000000010001000000000000000000000001000000070000000000000007000000000000"
    "000a00000000000100000000000000084a00000000000000070000000000000007000000000000001a00000000000000"
    "95000000000000000a0000000000af000000000000001f00000000000000000000006400000000000000640000000000"
    "00000e110000000000000003db0000000000000024000000000000000e110000000000000004ff000000000000001f00"
    "0000000000000e11000000000000000b1e0100000000000041000000000000000e1100000000000000085f0100000000"
    "00005300000000000000021400000000000000db00000000000000b201000000000000e51ac942894d434150300d0a";

std::string hex(const std::string& bytes) {
  std::string text;
  for (const char c : bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    text += kDigits[static_cast<std::uint8_t>(c) >> 4];
    text += kDigits[static_cast<std::uint8_t>(c) & 15];
  }
  return text;
}

/// Many messages of two channels, in chunks of 10 kB.
std::string many_messages(McapCompression compression) {
  std::ostringstream out;
  McapWriter writer(out, {.compression = compression, .chunk_bytes = 10'000});
  const auto schema = writer.add_schema({"S", "jsonschema", "{}"});
  const auto a = writer.add_channel("/a", "json", schema);
  const auto b = writer.add_channel("/b", "lcm", 0);
  writer.add_channel("/silent", "json", schema);
  for (std::uint64_t i = 0; i < 1000; ++i)
    writer.write(i % 3 == 0 ? b : a, 1'000'000 + 1000 * (i ^ 1), i, std::string(i % 90, static_cast<char>(i)));
  writer.finish();
  return out.str();
}

TEST(McapWriterTest, WritesTheBytesOfTheSpecification) {
  std::ostringstream out;
  McapWriter writer(out, {.compression = McapCompression::kNone, .library = "L"});
  const auto channel = writer.add_channel("/t", "json", writer.add_schema({"S", "jsonschema", "{}"}));
  writer.write(channel, 7, 5, "{}");
  writer.finish();
  EXPECT_EQ(hex(out.str()), kOneMessage);
  EXPECT_THAT(read_mcap(out.str()).errors, IsEmpty());
}

TEST(McapWriterTest, IsReadBackWithAllChecksumsIndexesAndCounts) {
  for (const auto compression : {McapCompression::kNone, McapCompression::kZstd}) {
    const McapFile file = read_mcap(many_messages(compression));
    EXPECT_THAT(file.errors, IsEmpty());
    EXPECT_GT(file.chunks, 3U);
    ASSERT_EQ(file.messages.size(), 1000U);
    EXPECT_EQ(file.channels.size(), 2U) << "a channel that says nothing is left out";
    EXPECT_EQ(file.messages[17].data, std::string(17, '\x11'));
    EXPECT_EQ(file.messages[17].log_time, 1'016'000U);
    EXPECT_EQ(file.messages[17].publish_time, 17U);
    EXPECT_EQ(file.channels.at(file.messages[3].channel).topic, "/b");
    EXPECT_EQ(file.schemas.at(1).name, "S");
  }
}

TEST(McapWriterTest, PacksWhatRepeats) {
  EXPECT_LT(many_messages(McapCompression::kZstd).size(), many_messages(McapCompression::kNone).size() * 3 / 4);
}

TEST(McapWriterTest, TheReaderOfTheseTestsSeesEachFlippedByteOfTheFile) {
  const std::string whole = many_messages(McapCompression::kNone);
  for (std::size_t i = 0; i < whole.size(); i += 97) {
    std::string flipped = whole;
    flipped[i] = static_cast<char>(flipped[i] ^ 0x10);
    EXPECT_FALSE(read_mcap(flipped).errors.empty()) << i;
  }
}

TEST(McapWriterTest, OfNothingIsAWholeFile) {
  std::ostringstream out;
  McapWriter writer(out, {});
  writer.finish();
  const McapFile file = read_mcap(out.str());
  EXPECT_THAT(file.errors, IsEmpty());
  EXPECT_EQ(file.library, "curbstone");
  EXPECT_THAT(file.messages, IsEmpty());
}

TEST(McapWriterTest, TakesAMessageThatIsLargerThanAChunk) {
  std::ostringstream out;
  McapWriter writer(out, {.chunk_bytes = 100});
  const auto channel = writer.add_channel("/large", "x", 0);
  writer.write(channel, 1, 1, std::string(100'000, 'x'));
  writer.write(channel, 2, 2, "small");
  writer.finish();
  const McapFile file = read_mcap(out.str());
  EXPECT_THAT(file.errors, IsEmpty());
  EXPECT_THAT(file.of("/large"), ElementsAre(std::string(100'000, 'x'), "small"));
}

TEST(McapWriterTest, SaysThatTheDiskIsFull) {
  std::ostringstream out;
  McapWriter writer(out, {.chunk_bytes = 100});
  const auto channel = writer.add_channel("/t", "x", 0);
  out.setstate(std::ios::badbit);
  EXPECT_THROW(writer.write(channel, 1, 1, std::string(200, 'x')), std::runtime_error);
}

}  // namespace
}  // namespace curbstone
