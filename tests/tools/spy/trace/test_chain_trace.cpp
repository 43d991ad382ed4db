#include "tools/spy/trace/chain_trace.hpp"

#include <gmock/gmock.h>

#include <curbstone/lidar_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/stamps.hpp"
#include "tests/tools/spy/encoded.hpp"
#include "tools/spy/trace/trace_json.hpp"

namespace curbstone::spy::trace {
namespace {

using Json = nlohmann::json;

using test::kStart;

void receive(ChainTrace& trace, const std::string& channel, const std::vector<std::uint8_t>& bytes, std::int64_t now) {
  trace.on_message(channel, bytes.data(), bytes.size(), now);
}

std::vector<std::uint8_t> packet(std::int64_t utime, std::int32_t revolution) {
  lidar_points_t points{};
  points.utime = utime;
  points.revolution = revolution;
  return encoded(points);
}

std::vector<std::uint8_t> pose(std::int64_t utime) {
  map_pose_t pose{};
  pose.utime = utime;
  return encoded(pose);
}

std::vector<std::uint8_t> status(const std::string& service, std::int64_t uptime, std::int64_t cpu) {
  service_status_t status{};
  status.utime = kStart;
  status.service = service;
  status.uptime = uptime;
  status.cpu_time = cpu;
  status.latency_p50 = 0.005F;
  status.latency_p99 = 0.01F;
  status.num_faults = 1;
  status.fault = {"a \"fault\""};
  return encoded(status);
}

/// The events of a row's name.
std::vector<Json> events_of(const Json& file, const std::string& name, const std::string& phase) {
  std::vector<Json> found;
  for (const Json& event : file.at("traceEvents"))
    if (event.at("name") == name && event.at("ph") == phase) found.push_back(event);
  return found;
}

TEST(ChainTrace, PacketsOfARevolutionAreOneSpanFromTheFirstShotToTheLastArrival) {
  ChainTrace trace;
  for (int i = 0; i < 37; ++i)
    receive(trace, "LIDAR_POINTS", packet(kStart + i * 1'350, 7), kStart + i * 1'350 + 2'000);
  receive(trace, "LIDAR_POINTS", packet(kStart + 50'000, 8), kStart + 52'000);
  ASSERT_EQ(trace.channels().at("LIDAR_POINTS").size(), 2U);
  const Span& span = trace.channels().at("LIDAR_POINTS").at(7);
  EXPECT_EQ(span.measured, kStart);
  EXPECT_EQ(span.first_arrival, kStart + 2'000);
  EXPECT_EQ(span.last_arrival, kStart + 36 * 1'350 + 2'000);
  EXPECT_EQ(span.messages, 37);
}

TEST(ChainTrace, MessagesOfOneStampAreOneSpan) {
  ChainTrace trace;
  for (const int ms : {12, 9, 20}) receive(trace, "MAP_POSE", pose(kStart), kStart + ms * 1'000);
  const Span& span = trace.channels().at("MAP_POSE").at(kStart);
  EXPECT_EQ(span.first_arrival, kStart + 12'000) << "as it came";
  EXPECT_EQ(span.last_arrival, kStart + 20'000);
  EXPECT_EQ(trace.spans(), 1U);
}

TEST(ChainTrace, ATileCountsWhenItFirstShowsAMeasurement) {
  ChainTrace trace;
  semantic_tile_t tile{};
  const auto send = [&](std::int32_t x, std::int64_t utime, int ms) {
    tile.tile_x = x;
    tile.utime = utime;
    receive(trace, "SEMANTIC_TILE", encoded(tile), kStart + ms * 1'000);
  };
  send(0, kStart, 30);
  send(1, kStart, 35);
  send(0, kStart, 400);  // its curbs
  const Span& span = trace.channels().at("SEMANTIC_TILE").at(kStart);
  EXPECT_EQ(span.messages, 2);
  EXPECT_EQ(span.last_arrival, kStart + 35'000);
  send(0, kStart + 50'000, 450);
  EXPECT_EQ(trace.channels().at("SEMANTIC_TILE").size(), 2U);
}

TEST(ChainTrace, WhatHasNoStampOrOneOfAnotherTimeIsLeftOut) {
  ChainTrace trace;
  receive(trace, "MAP_POSE", pose(std::numeric_limits<std::int64_t>::min()), kStart);
  receive(trace, "MAP_POSE", pose(std::numeric_limits<std::int64_t>::max()), kStart);
  receive(trace, "MAP_POSE", pose(kStart - 11'000'000), kStart);
  receive(trace, "MAP_POSE", {1, 2, 3}, kStart);
  auto cut = packet(kStart, 1);
  cut.resize(17);
  receive(trace, "LIDAR_POINTS", cut, kStart);
  EXPECT_EQ(trace.left_out(), 5);
  EXPECT_EQ(trace.spans(), 0U);
  EXPECT_TRUE(Json::accept(trace_json(trace)));
}

TEST(ChainTrace, AnyBytesAreSurvivedAndMemoryIsBounded) {
  ChainTrace trace;
  std::mt19937 random(3);
  for (int i = 0; i < 20'000; ++i) {
    auto bytes = i % 2 == 0 ? packet(kStart, i) : status("s", i, i);
    bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    receive(trace, i % 2 == 0 ? "LIDAR_POINTS" : "SERVICE_STATUS", bytes, kStart);
    receive(trace, "C" + std::to_string(i), pose(kStart), kStart);
  }
  EXPECT_LE(trace.channels().size(), ChainTrace::kMaxChannels);
  EXPECT_TRUE(Json::accept(trace_json(trace)));
}

TEST(TraceJson, IsWhatViewersOpenWithTheChainFromTopToBottom) {
  ChainTrace trace;
  receive(trace, "MAP_POSE", pose(kStart + 50'000), kStart + 63'000);
  receive(trace, "LIDAR_POINTS", packet(kStart, 7), kStart + 51'000);
  receive(trace, "SERVICE_STATUS", status("mapper", 1'000'000, 0), kStart + 10'000);
  receive(trace, "SERVICE_STATUS", status("mapper", 2'000'000, 250'000), kStart + 1'010'000);
  const Json file = Json::parse(trace_json(trace));
  const auto lidar = events_of(file, "LIDAR_POINTS", "X");
  ASSERT_EQ(lidar.size(), 1U);
  EXPECT_EQ(lidar[0].at("ts"), 0);
  EXPECT_EQ(lidar[0].at("dur"), 51'000);
  const auto poses = events_of(file, "MAP_POSE", "X");
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0].at("ts"), 50'000);
  EXPECT_EQ(poses[0].at("dur"), 13'000);
  EXPECT_EQ(poses[0].at("args").at("first_ms"), 13.0);
  EXPECT_LT(lidar[0].at("tid"), poses[0].at("tid"));
  const auto cpu = events_of(file, "mapper: CPU", "C");
  ASSERT_EQ(cpu.size(), 1U);
  EXPECT_EQ(cpu[0].at("args").at("cores"), 0.25);
  EXPECT_EQ(events_of(file, "mapper: latency p99", "C").size(), 2U);
  EXPECT_EQ(events_of(file, "mapper: a \"fault\"", "i").size(), 2U);
}

TEST(TraceJson, SpansThatOverlapHaveRowsOfTheirOwn) {
  ChainTrace trace;
  for (int i = 0; i < 4; ++i) receive(trace, "MAP_POSE", pose(kStart + i * 50'000), kStart + i * 50'000 + 70'000);
  std::map<int, std::int64_t> free_from;
  for (const Json& event : events_of(Json::parse(trace_json(trace)), "MAP_POSE", "X")) {
    EXPECT_GE(event.at("ts").get<std::int64_t>(), free_from[event.at("tid").get<int>()]);
    free_from[event.at("tid").get<int>()] = event.at("ts").get<std::int64_t>() + event.at("dur").get<std::int64_t>();
  }
  EXPECT_EQ(free_from.size(), 2U);
}

}  // namespace
}  // namespace curbstone::spy::trace
