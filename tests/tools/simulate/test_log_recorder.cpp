// A short drive to a log, through the devices' bytes and the drivers' nodes, read back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <fstream>
#include <map>

#include "common/log/log_reader.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/tools/simulate/drives.hpp"
#include "tools/simulate/log_recorder.hpp"
#include "tools/simulate/town_surroundings.hpp"

namespace curbstone::simulate {
namespace {

constexpr std::int64_t kStart = 1'750'000'000'000'000;

struct Messages {
  std::vector<imu_t> imu;
  std::vector<wheels_t> wheels;
  std::vector<lidar_points_t> lidar;
  std::vector<std::int64_t> log_times;
  std::map<std::string, std::vector<std::int64_t>> delays;
};

template <class Message>
void decode(const LogEvent& event, std::vector<Message>& into, Messages& all) {
  Message message;
  ASSERT_GE(message.decode(event.bytes.data(), 0, static_cast<int>(event.bytes.size())), 0);
  all.delays[event.channel].push_back(event.log_utime - message.utime);
  into.push_back(message);
}

Messages read_log(const std::string& file) {
  Messages all;
  LogReader log(file);
  while (const auto event = log.next()) {
    all.log_times.push_back(event->log_utime);
    if (event->channel == "IMU") decode(*event, all.imu, all);
    if (event->channel == "WHEELS") decode(*event, all.wheels, all);
    if (event->channel == "LIDAR_POINTS") decode(*event, all.lidar, all);
  }
  return all;
}

void record(const std::string& file, std::uint64_t seed, const motion::Motion& motion) {
  rig::SimulateConfig config;
  const rig::Drive drive{motion, [] { return std::make_unique<TownSurroundings>(test_town(), sensors::LidarNoise{}); },
                         config, 1200,
                         0,      seed,
                         6.0,    kStart};
  (void)record_drive(drive, file);
}

class LogRecorder : public ::testing::Test {
 protected:
  LogRecorder() { record(log_, 1, test_motion()); }
  test::TemporaryFolder folder_;
  std::string log_ = folder_ / "simulated.lcmlog";
};

TEST_F(LogRecorder, LogsWhatEveryDriverSaysInOrderOfTime) {
  const Messages all = read_log(log_);
  EXPECT_NEAR(static_cast<double>(all.lidar.size()), 6.0 / 0.001332, 2);
  EXPECT_NEAR(static_cast<double>(all.imu.size()), 600, 2);
  EXPECT_NEAR(static_cast<double>(all.wheels.size()), 600, 2);
  EXPECT_TRUE(std::is_sorted(all.log_times.begin(), all.log_times.end()));
  EXPECT_GE(all.log_times.front(), kStart);
  EXPECT_LE(all.log_times.back(), kStart + 6'000'000);
}

TEST_F(LogRecorder, GivesEveryMessageAPlausibleDelay) {
  for (const auto& [channel, delays] : read_log(log_).delays) {
    for (const auto delay : delays) {
      ASSERT_GE(delay, -100) << channel;
      ASSERT_LT(delay, 8'000) << channel;
    }
  }
}

TEST_F(LogRecorder, LosesNothingOnTheWay) {
  const Messages all = read_log(log_);
  for (std::size_t i = 1; i < all.lidar.size(); ++i) ASSERT_EQ(all.lidar[i].packet, all.lidar[i - 1].packet + 1);
  for (std::size_t i = 1; i < all.imu.size(); ++i) ASSERT_EQ(all.imu[i].sequence, all.imu[i - 1].sequence + 1);
  for (std::size_t i = 1; i < all.wheels.size(); ++i) ASSERT_EQ(all.wheels[i].sequence, all.wheels[i - 1].sequence + 1);
}

TEST_F(LogRecorder, StampsAreThoseOfTheMeasurements) {
  const Messages all = read_log(log_);
  // Every sample of the gyro against the true turn at its stamp would not tell microseconds; the wheels do: the stamp
  // of a count is right where the true way at that stamp is what was counted.
  const VehicleConfig vehicle;
  const wheels_t& last = all.wheels.back();
  const double t = static_cast<double>(last.utime - kStart) * 1e-6;
  const double way = 0.5 * (last.angle[0] + last.angle[1] - all.wheels.front().angle[0] - all.wheels.front().angle[1]) *
                     vehicle.wheel_radius;
  EXPECT_NEAR(way, test_motion().profile().distance(t), 0.02);
  EXPECT_TRUE(last.enabled);
  EXPECT_GT(last.counts[wheels_t::RIGHT], 100) << "forward is positive on the mirrored side too";
  for (std::size_t i = 1; i < all.imu.size(); ++i) {
    ASSERT_NEAR(static_cast<double>(all.imu[i].utime - all.imu[i - 1].utime), 10'000, 400);
    ASSERT_FALSE(std::isnan(all.imu[i].acceleration[2]));
  }
}

TEST_F(LogRecorder, TheSameSeedGivesTheSameLogBitForBit) {
  const auto bytes = [](const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const std::string first = bytes(log_);
  ASSERT_GT(first.size(), 1'000'000U);
  record(folder_ / "again.lcmlog", 1, test_motion());
  EXPECT_TRUE(first == bytes(folder_ / "again.lcmlog"));
  record(folder_ / "other.lcmlog", 2, test_motion());
  EXPECT_FALSE(first == bytes(folder_ / "other.lcmlog"));
}

TEST(LogRecorderOfLidars, MakesAMessageOfEachPacketOfEveryDevice) {
  const std::pair<devices::LidarName, double> devices[] = {{devices::LidarName::kVlp16, 1327.104e-6},
                                                           {devices::LidarName::kHelios16p, 1333.44e-6},
                                                           {devices::LidarName::kHelios32, 666.72e-6}};
  for (const auto& [name, period] : devices) {
    const test::TemporaryFolder folder;
    const std::string log = folder / "simulated.lcmlog";
    const rig::SimulateConfig config;
    const rig::Drive drive{
        .motion = test_motion(),
        .make_surroundings = [] { return std::make_unique<TownSurroundings>(test_town(), sensors::LidarNoise{}); },
        .config = config,
        .seconds = 1.0,
        .start_utime = kStart,
        .lidar = name};
    (void)record_drive(drive, log);
    const Messages all = read_log(log);
    EXPECT_NEAR(static_cast<double>(all.lidar.size()), 1.0 / period, 4) << period;
    ASSERT_FALSE(all.lidar.empty());
    EXPECT_NEAR(static_cast<double>(all.lidar.front().utime - kStart), 0, 3 * period * 1e6);
  }
}

}  // namespace
}  // namespace curbstone::simulate
