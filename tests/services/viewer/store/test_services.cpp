#include <gmock/gmock.h>

#include "services/viewer/state_json.hpp"
#include "services/viewer/store/services.hpp"
#include "services/viewer/store/thinned_path.hpp"

namespace curbstone::viewer::store {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

service_status_t status(const std::string& name, std::int64_t second) {
  service_status_t message{};
  message.service = name;
  message.pid = 7;
  message.uptime = second * 1'000'000;
  message.cpu_time = second * 250'000;
  message.counter_name = {"dropped.queue", "packets"};
  message.counter_value = {second * 3, second * 100};
  message.num_counters = 2;
  return message;
}

TEST(ServicesTest, MakesRatesOfTwoMessages) {
  Services services;
  services.put(status("mapper", 10), 1);
  EXPECT_EQ(services.all().at("mapper").cpu, 0);
  services.put(status("mapper", 12), 2);
  const Services::Service& mapper = services.all().at("mapper");
  EXPECT_DOUBLE_EQ(mapper.cpu, 0.25);
  ASSERT_THAT(mapper.losses, SizeIs(1));
  EXPECT_EQ(mapper.losses[0].name, "dropped.queue");
  EXPECT_DOUBLE_EQ(mapper.losses[0].rate, 3);
  EXPECT_EQ(mapper.heard, 2);
}

TEST(ServicesTest, AProcessThatWasRestartedBeginsAnew) {
  Services services;
  services.put(status("mapper", 10), 1);
  services.put(status("mapper", 1), 2);
  EXPECT_EQ(services.all().at("mapper").cpu, 0);
  EXPECT_EQ(services.all().at("mapper").losses[0].rate, 0);
}

TEST(ServicesTest, AreBoundedInNumberAndSize) {
  Services services;
  for (std::size_t i = 0; i < Services::kMaxServices; ++i) EXPECT_TRUE(services.put(status(std::to_string(i), 1), 1));
  EXPECT_FALSE(services.put(status("one more", 1), 1));
  service_status_t message = status("0", 2);
  message.fault.assign(1000, std::string(10'000, 'x'));
  message.counter_name.assign(1000, "dropped." + std::string(10'000, 'x'));
  message.counter_value.assign(1000, 1);
  EXPECT_TRUE(services.put(message, 2));
  const Services::Service& service = services.all().at("0");
  EXPECT_THAT(service.faults, SizeIs(Services::kMaxFaults));
  EXPECT_THAT(service.losses, SizeIs(Services::kMaxCounters));
  EXPECT_THAT(service.faults[0], SizeIs(Services::kMaxText));
}

TEST(ServicesTest, WhateverBytesANameHasTheJsonIsUtf8) {
  Services services;
  service_status_t message = status("map\xff\"per", 1);
  message.latency_p50 = NAN;
  services.put(message, 1);
  const std::string json = services_json(services, 2'000'001);
  EXPECT_THAT(json, HasSubstr("map\xef\xbf\xbd\\\"per"));
  EXPECT_THAT(json, HasSubstr(R"("age":2.0)"));
  EXPECT_THAT(json, HasSubstr(R"("latency":[null,)"));
}

TEST(ThinnedPathTest, KeepsAPointEachQuarterOfAMetreInOrderOfTime) {
  ThinnedPath path;
  for (int i = 0; i <= 100; ++i) path.put({.utime = i, .x = static_cast<float>(i) * 0.0625F});
  EXPECT_THAT(path.points(), SizeIs(26));
  const std::uint32_t round = path.round();
  path.put({.utime = 50, .x = 3.1F});
  EXPECT_EQ(path.round(), round) << "it was there";
  path.put({.utime = 50, .x = 3.1F, .y = 5});
  EXPECT_THAT(path.points(), SizeIs(27));
  EXPECT_GT(path.round(), round) << "listeners need all of it again";
  EXPECT_TRUE(std::is_sorted(path.points().begin(), path.points().end(),
                             [](const auto& a, const auto& b) { return a.utime < b.utime; }));
  path.clear();
  EXPECT_THAT(path.points(), SizeIs(0));
}

TEST(ThinnedPathTest, IsInTheOrderOfTheDriveWhereTheClockIsSetBack) {
  ThinnedPath path;
  for (int i = 0; i < 5; ++i) path.append({9'000'000'000 + i * 100'000, static_cast<float>(i), 0, 0});
  const std::uint32_t round = path.round();
  for (int i = 5; i < 10; ++i) path.append({5'000'000'000 + i * 100'000, static_cast<float>(i), 0, 0});
  ASSERT_EQ(path.points().size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(path.points()[i].x, static_cast<float>(i));
  EXPECT_EQ(path.round(), round) << "pages are sent the new points alone";
}

TEST(ThinnedPathTest, HasAnEnd) {
  ThinnedPath path;
  for (std::size_t i = 0; i < ThinnedPath::kMaxPoints + 5; ++i)
    path.put({.utime = static_cast<std::int64_t>(i), .x = static_cast<float>(i)});
  EXPECT_THAT(path.points(), SizeIs(ThinnedPath::kMaxPoints));
}

}  // namespace
}  // namespace curbstone::viewer::store
