#include "tools/bench/sensor_faults/catalogue/catalogue.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "tests/tools/bench/sensor_faults/catalogue/fault_helpers.hpp"
#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"
#include "tools/bench/sensor_faults/catalogue/faulty_messages.hpp"

namespace curbstone::bench::sensor_faults::catalogue {
namespace {

template <class Message>
LogEvent event_of(const std::string& channel, const Message& message) {
  LogEvent event{message.utime, channel, std::vector<std::uint8_t>(std::size_t(message.getEncodedSize()))};
  message.encode(event.bytes.data(), 0, message.getEncodedSize());
  return event;
}

std::vector<LogEvent> some_events(int n) {
  std::vector<LogEvent> events;
  for (int i = 0; i < n; ++i) {
    const std::int64_t utime = 1'000'000 + 10'000 * i;
    std::vector<SomePoint> points;
    for (int k = 0; k < 40; ++k)
      points.push_back(
          {20.0F * std::cos(0.157F * float(k)), 20.0F * std::sin(0.157F * float(k)), k % 2 == 0 ? -1.0F : -1.7F});
    points.push_back({3.0F, 0.0F, 1.0F});  // above it
    lidar_points_t lidar = some_points(points, utime);
    lidar.revolution = i / 3;
    imu_t imu = some_imu(utime);
    imu.acceleration[0] += i, imu.acceleration[2] = 9.81 + 0.001 * i, imu.angular_rate[2] += 0.001 * i;
    wheels_t wheels = some_wheels(utime);
    wheels.counts[0] += 10 * i, wheels.angle[0] += 0.01 * i;
    events.push_back(event_of("LIDAR_POINTS", lidar));
    events.push_back(event_of("IMU", imu));
    events.push_back(event_of("WHEELS", wheels));
  }
  return events;
}

constexpr int kEvents = 800;  // of each sensor, in 15 s

/// The bytes of the messages that are sent.
std::vector<std::vector<std::uint8_t>> sent(const Fault& fault, double first_t) {
  FaultyMessages messages(fault.make(), fault.from);
  std::vector<std::vector<std::uint8_t>> bytes;
  double t = first_t;
  for (LogEvent& event : some_events(kEvents)) {
    const std::optional<LogEvent> second = messages.second(t, event);
    if (messages.apply(t, event)) bytes.push_back(event.bytes);
    if (second) bytes.push_back(second->bytes);
    t += 15.0 / (3 * kEvents);
  }
  return bytes;
}

TEST(SensorFaultCatalogue, NamesAreUniqueAndSaySomething) {
  std::set<std::string> names;
  const std::set<std::string> sensors = {"vehicle file", "wheels", "IMU", "LiDAR", "host clock", "bus", "surroundings"};
  for (const Fault& fault : all_faults()) {
    EXPECT_TRUE(names.insert(fault.name).second) << fault.name;
    EXPECT_TRUE(sensors.contains(fault.sensor)) << fault.name;
    EXPECT_FALSE(fault.words.empty()) << fault.name;
    const Changes changes = fault.make();
    EXPECT_TRUE(changes.lidar || changes.imu || changes.wheels || changes.second_lidar || changes.second_imu ||
                changes.second_wheels || !fault.settings.empty())
        << fault.name;
  }
}

TEST(SensorFaultCatalogue, BeforeItsTimeAFaultChangesNothing) {
  const auto unchanged = sent(Fault{}, 0);
  ASSERT_EQ(unchanged.size(), 3U * kEvents);
  for (const Fault& fault : all_faults()) {
    if (fault.from == 0) continue;
    EXPECT_EQ(sent(fault, fault.from - 20), unchanged) << fault.name;  // ends 5 s before
  }
}

TEST(SensorFaultCatalogue, EachReplayGetsTheSameFault) {
  const auto unchanged = sent(Fault{}, 0);
  for (const Fault& fault : all_faults()) {
    const auto first = sent(fault, fault.from);
    EXPECT_EQ(sent(fault, fault.from), first) << fault.name;
    EXPECT_EQ(first == unchanged, !fault.settings.empty()) << fault.name;
  }
}

TEST(SensorFaultCatalogue, ASecondSendersMessagesFollowUnchangedOnes) {
  const auto unchanged = sent(Fault{}, 0);
  for (const char* name : {"second LiDAR", "second IMU", "second encoder"}) {
    const auto both = sent(fault_named(name), 20);
    ASSERT_EQ(both.size(), 4U * kEvents) << name;
    for (std::size_t i = 0; i < unchanged.size(); i += 50) EXPECT_THAT(both, testing::Contains(unchanged[i])) << name;
  }
}

TEST(SensorFaultCatalogue, NothingIsWrongInAFaultlessDrive) {
  const auto unchanged = sent(Fault{}, 0);
  std::set<std::string> names;
  for (const Fault& drive : faultless_drives()) {
    EXPECT_TRUE(names.insert(drive.name).second) << drive.name;
    EXPECT_EQ(sent(drive, 0), unchanged) << drive.name;
    EXPECT_TRUE(drive.settings.empty() && !drive.drive.empty()) << drive.name;
  }
}

TEST(SensorFaultCatalogue, OtherChannelsAndBrokenMessages) {
  FaultyMessages messages(fault_named("IMU silent").make(), 0);
  LogEvent event{1, "CONFIG", {1, 2, 3}};
  EXPECT_TRUE(messages.apply(20, event));
  EXPECT_EQ(event.bytes, (std::vector<std::uint8_t>{1, 2, 3}));
  event.channel = "IMU";
  EXPECT_THROW((void)messages.apply(20, event), std::runtime_error);
}

TEST(SensorFaultCatalogue, IsChosenByARegularExpression) {
  EXPECT_EQ(named(all_faults(), "").size(), all_faults().size());
  EXPECT_EQ(named(all_faults(), "^IMU: gyro (0|frozen)$").size(), 2U);
  for (const Fault& fault : named(all_faults(), "^wheels: ")) EXPECT_EQ(fault.sensor, "wheels");
  EXPECT_THROW((void)named(all_faults(), "("), std::runtime_error);
  EXPECT_THROW((void)named(all_faults(), "no such fault"), std::runtime_error);
}

TEST(SensorFaultCatalogue, TheFileIsWrongInOneThing) {
  EXPECT_THAT(fault_named("LiDAR 0.4 m too high").settings,
              ::testing::ElementsAre("vehicle.lidar=[0, 0, 2.13, 0, 0, 0]"));
  EXPECT_THAT(fault_named("LiDAR yaw 180 deg").settings[0], ::testing::HasSubstr("[0, 0, 1.73, 0, 0, 3.14159"));
  EXPECT_THAT(fault_named("LiDAR roll 180 deg").settings[0], ::testing::HasSubstr("[0, 0, 1.73, 3.14159"));
  EXPECT_THAT(fault_named("track 10 % narrow").settings[0], ::testing::HasSubstr("vehicle.track_width=0.72"));
}

}  // namespace
}  // namespace curbstone::bench::sensor_faults::catalogue
