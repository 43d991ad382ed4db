#include "common/json/json_text.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/temporary_folder.hpp"

namespace curbstone {
namespace {

TEST(JsonText, IsOnOneLineOrIndented) {
  EXPECT_EQ(json_text({{"a", 1}}), R"({"a":1})");
  EXPECT_EQ(json_text({{"a", 1}}, 2), "{\n  \"a\": 1\n}");
}

TEST(JsonText, ReplacesBytesThatAreNoUtf8) {
  EXPECT_EQ(json_text("a\xff"), "\"a\xef\xbf\xbd\"");
}

TEST(JsonText, WhatIsNotJsonIsAnErrorOrDiscarded) {
  EXPECT_EQ(parse_json(R"({"a":1})").at("a"), 1);
  EXPECT_THROW((void)parse_json("{"), nlohmann::json::parse_error);
  EXPECT_TRUE(try_parse_json("{").is_discarded());
  EXPECT_EQ(try_parse_json("[1]").at(0), 1);
}

TEST(JsonText, IsReadFromAFile) {
  const test::TemporaryFolder folder;
  const std::string file = (folder / "a.json").string();
  EXPECT_THROW((void)read_json(file), nlohmann::json::parse_error);
  std::ofstream(file) << "[1, 2]";
  EXPECT_EQ(read_json(file).size(), 2U);
}

}  // namespace
}  // namespace curbstone
