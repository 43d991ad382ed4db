#include <gtest/gtest.h>

#include <curbstone/curb_lines_t.hpp>
#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <curbstone/service_status_t.hpp>
#include <map>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <random>

#include "common/bytes/big_endian.hpp"
#include "common/message_types/field_values.hpp"
#include "common/message_types/type_parser.hpp"

namespace curbstone {
namespace {

template <class Message>
std::vector<std::uint8_t> encoded_bytes(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, message.getEncodedSize());
  return bytes;
}

std::vector<std::uint8_t> fingerprint_bytes(const TypeTable& table, const std::string& name) {
  std::vector<std::uint8_t> bytes;
  append_big_endian(bytes, static_cast<std::uint64_t>(table.fingerprint(name).value()));
  return bytes;
}

std::map<std::string, std::string> texts_of(const std::vector<std::uint8_t>& bytes) {
  std::map<std::string, std::string> texts;
  const auto values = decode_values(TypeTable::built_in(), bytes.data(), bytes.size());
  EXPECT_TRUE(values);
  if (values) {
    for (const NamedValue& value : *values) texts[value.name] = to_text(value.value);
  }
  return texts;
}

template <class Message>
void expect_known(const char* name) {
  const MessageType* type = TypeTable::built_in().find(Message::getHash());
  ASSERT_NE(type, nullptr) << name;
  EXPECT_EQ(type->name, name);
}

TEST(TypeTable, KnowsTypesByTheFingerprintThatLcmGenGivesThem) {
  expect_known<imu_t>("curbstone.imu_t");
  expect_known<lidar_points_t>("curbstone.lidar_points_t");
  expect_known<curb_lines_t>("curbstone.curb_lines_t");  // holds another type
  expect_known<map_trajectory_t>("curbstone.map_trajectory_t");
  expect_known<semantic_tile_t>("curbstone.semantic_tile_t");
  expect_known<service_status_t>("curbstone.service_status_t");
  expect_known<procman_lcm::orders_t>("procman_lcm.orders_t");
  expect_known<procman_lcm::deputy_info_t>("procman_lcm.deputy_info_t");
  EXPECT_EQ(TypeTable::built_in().find(std::int64_t{1}), nullptr);
}

TEST(FieldValues, AMessageIsItsFieldsInTheirOrder) {
  imu_t message{};
  message.utime = 1'700'000'000'123'456;
  message.acceleration[2] = 9.81;
  message.has_orientation = 1;
  message.temperature = 0.1F;
  const auto bytes = encoded_bytes(message);
  const auto values = decode_values(TypeTable::built_in(), bytes.data(), bytes.size());
  ASSERT_TRUE(values);
  ASSERT_EQ(values->size(), 15U);
  EXPECT_EQ(values->front().name, "utime");
  EXPECT_EQ(to_text(values->front().value), "1700000000123456");
  const auto texts = texts_of(bytes);
  EXPECT_EQ(texts.at("acceleration[2]"), "9.81");
  EXPECT_EQ(texts.at("has_orientation"), "true");
  EXPECT_EQ(texts.at("temperature"), "0.1");
}

TEST(FieldValues, ArraysOfVariableLengthAndMessagesWithinMessages) {
  curb_lines_t message{};
  message.num_lines = 2;
  message.lines.resize(2);
  message.lines[1].rise = -1;
  message.lines[1].num_points = 1;
  for (auto* column : {&message.lines[1].x, &message.lines[1].y, &message.lines[1].z, &message.lines[1].height,
                       &message.lines[1].high_side_x, &message.lines[1].high_side_y})
    *column = {2.5F};
  const auto texts = texts_of(encoded_bytes(message));
  EXPECT_EQ(texts.at("lines[1].rise"), "-1");
  EXPECT_EQ(texts.at("lines[1].height[0]"), "2.5");
  EXPECT_FALSE(texts.contains("lines[0].height[0]"));

  service_status_t status{};
  status.service = "ekf";
  status.num_faults = 1;
  status.fault = {"no IMU"};
  EXPECT_EQ(texts_of(encoded_bytes(status)).at("fault[0]"), "no IMU");
}

TEST(FieldValues, WhatIsNoWholeMessageIsRefused) {
  lidar_points_t message{};
  message.num_points = 1;
  message.x = message.y = message.z = message.time_offset = {1.0F};
  message.intensity = message.ring = {1};
  auto bytes = encoded_bytes(message);
  const auto decodes = [&] { return decode_values(TypeTable::built_in(), bytes.data(), bytes.size()).has_value(); };
  EXPECT_TRUE(decodes());
  bytes.push_back(0);
  EXPECT_FALSE(decodes()) << "a byte too many";
  bytes.resize(bytes.size() - 2);
  EXPECT_FALSE(decodes()) << "a byte too few";
  bytes = encoded_bytes(message);
  bytes[8 + 16] = 0xFF;
  EXPECT_FALSE(decodes()) << "a negative length";
  bytes.resize(7);
  EXPECT_FALSE(decodes()) << "no fingerprint";
}

TEST(FieldValues, ALengthWithoutBytesIsNoWorkWithoutEnd) {
  TypeTable table;
  table.add("package p; struct none_t { } struct many_t { int32_t n; none_t x[n]; }");
  std::vector<std::uint8_t> bytes = fingerprint_bytes(table, "p.many_t");
  bytes.insert(bytes.end(), {0x7F, 0xFF, 0xFF, 0xFF});
  ASSERT_NE(table.type_of(bytes.data(), bytes.size()), nullptr);
  EXPECT_FALSE(decode_values(table, bytes.data(), bytes.size()));
}

TEST(FieldValues, FlippedBitsNeverCrash) {
  service_status_t status{};
  status.service = "ekf";
  status.num_counters = 2;
  status.counter_name = {"a", "b"};
  status.counter_value = {1, 2};
  const auto whole = encoded_bytes(status);
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    auto bytes = whole;
    for (int flips = 0; flips < 3; ++flips) {
      std::uint8_t& byte = bytes[8 + random() % (bytes.size() - 8)];
      byte = static_cast<std::uint8_t>(byte ^ (1U << random() % 8));
    }
    if (i % 2 == 0) bytes.resize(8 + random() % (bytes.size() - 8));
    const auto values = decode_values(TypeTable::built_in(), bytes.data(), bytes.size(), 10'000);
    EXPECT_LE(values ? values->size() : 0, 10'020U);
  }
}

TEST(TypeParser, ReadsWhatTheTypeSpecificationAllows) {
  const auto types = parse_message_types(
      "/* a comment */ package robot.arm;\n"
      "struct pose_t { const int32_t A = 1, B = -2; double x, y[3]; // more\n"
      "  int16_t n; other.thing_t t[n][2]; pose_t own; }\n");
  ASSERT_EQ(types.size(), 1U);
  EXPECT_EQ(types[0].name, "robot.arm.pose_t");
  ASSERT_EQ(types[0].fields.size(), 5U);
  EXPECT_EQ(types[0].fields[1].dimensions[0].text, "3");
  EXPECT_EQ(types[0].fields[3].type, "other.thing_t");
  EXPECT_FALSE(types[0].fields[3].dimensions[0].fixed);
  EXPECT_TRUE(types[0].fields[3].dimensions[1].fixed);
  EXPECT_EQ(types[0].fields[4].type, "robot.arm.pose_t");
}

TEST(TypeParser, SaysTheLineAtWhichItFails) {
  for (const char* text : {"package p;\nstruct {", "package p;\nstruct a_t { int32_t x", "\nenum a_t { A }",
                           "\nstruct a_t { byte x[9999999999]; }", "\nstruct a_t { byte x[1"}) {
    try {
      (void)parse_message_types(text);
      FAIL() << text;
    } catch (const std::runtime_error& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with("line 2: ")) << error.what();
    }
  }
}

}  // namespace
}  // namespace curbstone
