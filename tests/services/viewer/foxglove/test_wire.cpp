#include "services/viewer/foxglove/wire.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace curbstone::viewer::foxglove {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;

std::string hex(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

TEST(FoxgloveWireTest, DataIsAsTheProtocolHasIt) {
  EXPECT_EQ(hex(data_frame(0, 1'700'000'000'000'000, "{}")),
            "01000000000000"
            "2a36fe9c9717"
            "7b7d");
  EXPECT_EQ(hex(data_frame(0x01020304, 1, "")), "0104030201e803000000000000");
}

TEST(FoxgloveWireTest, TheServerOffersNothingToBeChanged) {
  const json said = json::parse(server_info("Curbstone", "17"));
  EXPECT_EQ(said["op"], "serverInfo");
  EXPECT_EQ(said["capabilities"], json::array());
  EXPECT_EQ(said["sessionId"], "17");
}

TEST(FoxgloveWireTest, BinarySchemasAreBase64AndTextIsText) {
  const auto schema_of = [](const std::string& schema, const std::string& encoding) {
    return json::parse(advertise({{7, "/t", "x", "S", encoding, schema}}))["channels"][0]["schema"].get<std::string>();
  };
  EXPECT_EQ(schema_of("{}", "jsonschema"), "{}");
  EXPECT_EQ(schema_of("Man", "protobuf"), "TWFu");
  EXPECT_EQ(schema_of("Ma", "protobuf"), "TWE=");
  EXPECT_EQ(schema_of("M", "protobuf"), "TQ==");
  EXPECT_EQ(schema_of("\xff\xfe\xfd\xfc", "protobuf"), "//79/A==");
  EXPECT_EQ(schema_of("", "protobuf"), "");
}

TEST(FoxgloveWireTest, ReadsWhatAClientAsksFor) {
  const auto subscribe =
      parse_request(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":9,"channelId":4}]})");
  ASSERT_TRUE(subscribe);
  ASSERT_EQ(subscribe->subscribe.size(), 2U);
  EXPECT_EQ(subscribe->subscribe[1].id, 9U);
  EXPECT_EQ(subscribe->subscribe[1].channel, 4U);
  EXPECT_THAT(parse_request(R"({"op":"unsubscribe","subscriptionIds":[9,0]})")->unsubscribe, ElementsAre(9, 0));
}

TEST(FoxgloveWireTest, RefusesWhatIsNoRequest) {
  for (const char* text :
       {"", "{", "[]", "\x01\x02", R"({"op":7})", R"({"op":"advertise","channels":[]})", R"({"op":"subscribe"})",
        R"({"op":"subscribe","subscriptions":{}})", R"({"op":"subscribe","subscriptions":[7]})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":3}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":4294967296}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":18446744073709551615,"channelId":1}]})",
        R"({"op":"unsubscribe","subscriptionIds":["a"]})", R"({"op":"unsubscribe","subscriptionIds":[null]})"})
    EXPECT_FALSE(parse_request(text)) << text;
}

}  // namespace
}  // namespace curbstone::viewer::foxglove
