#include "tools/evaluate/run_log.hpp"

#include <gmock/gmock.h>

#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <curbstone/service_status_t.hpp>
#include <curbstone/wheels_t.hpp>

#include "common/log/log_writer.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::evaluate {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::Pair;

template <class Message>
void write(LogWriter& log, const std::string& channel, const Message& message, std::int64_t log_utime) {
  std::vector<std::uint8_t> bytes(1 << 14);
  const int size = message.encode(bytes.data(), 0, 1 << 14);
  log.write(channel, bytes.data(), size, log_utime);
}

service_status_t status(const std::string& service, std::int64_t uptime, std::int64_t cpu, std::int64_t dropped) {
  service_status_t s{};
  s.service = service;
  s.uptime = uptime;
  s.cpu_time = cpu;
  s.memory = 30'000'000 + 3'000'000 * dropped;
  s.num_counters = 3;
  s.counter_name = {"dropped.queue", "refused.jump", "memory.own_kb"};  // what a service thinks of an answer is no loss
  s.counter_value = {dropped, 7, 25'000 + 3'000 * dropped};
  return s;
}

TEST(RunLog, SumsLossesLatencyAndCores) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "run.lcmlog";
  {
    LogWriter log(file);
    lidar_points_t lidar{};
    semantic_tile_t tile{};
    write(log, "SERVICE_STATUS", status("mapper", 0, 0, 0), 1);
    lidar.utime = 999'000;
    write(log, "LIDAR_POINTS", lidar, 1'000'000);
    odometry_t odometry{};
    odometry.utime = 968'000;
    write(log, "ODOMETRY", odometry, 970'000);
    map_pose_t pose{};
    pose.utime = 950'000;
    write(log, "MAP_POSE", pose, 980'000);
    tile.utime = 950'000;
    write(log, "SEMANTIC_TILE", tile, 1'000'000);
    write(log, "SERVICE_STATUS", status("mapper", 1'000'000, 250'000, 3), 1'000'000);
    write(log, "SEMANTIC_TILE", tile, 1'900'000);  // for its neighbours' sake: nothing new was measured in it
    lidar.packet = 1;
    lidar.utime = 1'999'000;
    write(log, "LIDAR_POINTS", lidar, 2'000'000);
    tile.utime = 8'000'000;
    write(log, "SEMANTIC_TILE", tile, 9'000'000);  // after the drive: no latency of driving
    write(log, "SERVICE_STATUS", status("mapper", 9'000'000, 250'000, 4), 9'000'000);
  }
  const RunFigures run = read_run_log(file);
  EXPECT_EQ(run.processes, 1);
  EXPECT_EQ(run.lost_messages, 4);
  EXPECT_EQ(run.lost_packets, 0);
  ASSERT_TRUE(run.latency);
  EXPECT_EQ(run.latency->messages, 1);
  EXPECT_NEAR(run.latency->p95_ms, 50, 1e-9);
  EXPECT_NEAR(run.stages.at("LIDAR_POINTS").p50_ms, 1, 1e-9);
  EXPECT_NEAR(run.stages.at("ODOMETRY").p50_ms, 2, 1e-9);
  EXPECT_NEAR(run.stages.at("MAP_POSE").p50_ms, 30, 1e-9);
  EXPECT_NEAR(run.cores.at("mapper"), 0.25, 1e-9);
  EXPECT_NEAR(run.memory_mb.at("mapper"), 39, 1e-9) << "the last that it said in the drive";
  EXPECT_NEAR(run.own_memory_mb.at("mapper"), 34, 1e-9);
}

TEST(RunLog, TellsTheMemoryAfterAMinuteFromThatAtTheEnd) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "minutes.lcmlog";
  {
    LogWriter log(file);
    write(log, "LIDAR_POINTS", lidar_points_t{}, 5'000'000);
    for (int s = 4; s < 130; ++s) {  // its memory grows by 3 MB at 64, 66, 100 and 120 s
      const int grown = (s >= 64) + (s >= 66) + (s >= 100) + (s >= 120);
      write(log, "SERVICE_STATUS", status("mapper", 1'000'000 * s, 0, grown), 1'000'000 * s);
      write(log, "LIDAR_POINTS", lidar_points_t{}, 1'000'000 * s + 1'500'000);
    }
  }
  const RunFigures run = read_run_log(file);
  EXPECT_NEAR(run.own_memory_after_a_minute_mb.at("mapper"), 28, 1e-9) << "at 65 s";
  EXPECT_NEAR(run.own_memory_mb.at("mapper"), 37, 1e-9);
}

TEST(RunLog, TheRareLatenessShowsInTheUpperQuantiles) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "late.lcmlog";
  {
    LogWriter log(file);
    semantic_tile_t tile{};
    for (int i = 1; i <= 1000; ++i) {  // 1 ms, but 100 ms for one in fifty, and once 400
      tile.utime = 1'000'000 * i;
      write(log, "SEMANTIC_TILE", tile, tile.utime + (i == 500 ? 400'000 : i % 50 == 0 ? 100'000 : 1'000));
    }
    write(log, "LIDAR_POINTS", lidar_points_t{}, 2'000'000'000);
  }
  const RunFigures run = read_run_log(file);
  ASSERT_TRUE(run.latency);
  EXPECT_NEAR(run.latency->p95_ms, 1, 1e-9);
  EXPECT_NEAR(run.latency->p99_ms, 100, 1e-9);
  EXPECT_NEAR(run.latency->max_ms, 400, 1e-9);
}

TEST(RunLog, WhatANewEpochMovesIntoAnotherTileIsNotLate) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "epochs.lcmlog";
  {
    LogWriter log(file);
    semantic_tile_t tile{};
    const auto show = [&](int epoch, int x, int measured_s, int ms_later) {
      tile.epoch = epoch;
      tile.tile_x = x;
      tile.utime = 1'000'000 * measured_s;
      write(log, "SEMANTIC_TILE", tile, tile.utime + 1'000 * ms_later);
    };
    show(1, 0, 10, 20);
    show(1, 1, 40, 30);
    show(2, 0, 40, 50'000);  // a loop was closed at 90 s: what tile 1 showed lies in tile 0 now
    show(2, 0, 91, 40);
    write(log, "LIDAR_POINTS", lidar_points_t{}, 200'000'000);
  }
  const RunFigures run = read_run_log(file);
  ASSERT_TRUE(run.latency);
  EXPECT_EQ(run.latency->messages, 3);
  EXPECT_NEAR(run.latency->max_ms, 40, 1e-9);
}

TEST(RunLog, SaysHowLongAfterTheFirstPacketThereWasAMapAndTheVehicleSetOff) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "start.lcmlog";
  {
    LogWriter log(file);
    lidar_points_t lidar{};
    lidar.utime = 9'999'000;
    write(log, "LIDAR_POINTS", lidar, 10'000'000);
    map_pose_t pose{};
    map_points_t points{};
    semantic_tile_t tile{};
    points.utime = tile.utime = 11'200'000;
    write(log, "MAP_POINTS", points, 11'500'000);
    write(log, "SEMANTIC_TILE", tile, 11'750'000);
    for (int i = 0; i < 60; ++i) {
      pose.utime = 11'000'000 + 50'000 * i;
      pose.map_base_position[0] = i < 50 ? 0.001 : 0.06;
      write(log, "MAP_POSE", pose, pose.utime + 20'000);
    }
    points.utime = tile.utime = 15'000'000;
    write(log, "SEMANTIC_TILE", tile, 15'100'000);
    lidar.packet = 1;
    write(log, "LIDAR_POINTS", lidar, 20'000'000);
  }
  const RunFigures run = read_run_log(file);
  EXPECT_THAT(run.first_after_s,
              ElementsAre(Pair("MAP_POINTS", DoubleNear(1.5, 1e-9)), Pair("MAP_POSE", DoubleNear(1.02, 1e-9)),
                          Pair("SEMANTIC_TILE", DoubleNear(1.75, 1e-9))));
  ASSERT_TRUE(run.set_off_after_s);
  EXPECT_NEAR(*run.set_off_after_s, 3.52, 1e-9);
}

TEST(RunLog, EachProcessReportsTheDatagramsOfItsOwnSocketThatWereDropped) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "full_buffers.lcmlog";
  {
    LogWriter log(file);
    for (const auto& [service, dropped] : {std::pair{"mapper", 5}, std::pair{"ekf", 4}}) {
      service_status_t s = status(service, 1'000'000, 0, dropped);
      s.counter_name[0] = "dropped.kernel";
      write(log, "SERVICE_STATUS", s, 1'000'000);
    }
  }
  EXPECT_EQ(read_run_log(file).lost_messages, 9);
  EXPECT_EQ(read_run_log(file).losses.at("ekf dropped.kernel"), 4);
}

TEST(RunLog, WhatAFollowerOfTilesLeavesOutIsNoLoss) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "left_out.lcmlog";
  {
    LogWriter log(file);
    for (const char* const counter : {"dropped.known", "dropped.superseded", "dropped.other_epoch"}) {
      service_status_t s = status("viewer", 1'000'000, 0, 3);
      s.counter_name[0] = counter;
      write(log, "SERVICE_STATUS", s, 1'000'000);
      s.utime += 1'000'000;
      write(log, "SERVICE_STATUS", s, 2'000'000);
    }
  }
  EXPECT_EQ(read_run_log(file).lost_messages, 0);
  EXPECT_TRUE(read_run_log(file).losses.empty());
}

TEST(RunLog, SaysNothingOfLatencyInALogThatWasNotRecordedLive) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "replayed.lcmlog";
  {
    LogWriter log(file);
    lidar_points_t lidar{};
    semantic_tile_t tile{};
    tile.utime = lidar.utime = 1'000'000;
    write(log, "SEMANTIC_TILE", tile, 0);  // the record's time is the message's own
    write(log, "LIDAR_POINTS", lidar, 0);
  }
  EXPECT_FALSE(read_run_log(file).latency);
  EXPECT_TRUE(read_run_log(file).cores.empty());
  EXPECT_EQ(read_run_log(file).processes, 0);
}

TEST(RunLog, SeesWhatTheRecorderMissed) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "gaps.lcmlog";
  {
    LogWriter log(file);
    lidar_points_t lidar{};
    for (const int packet : {7, 8, 11, 12, 0, 1, 3}) {  // 9, 10 and 2 are missing; the driver began anew at 0
      lidar.packet = packet;
      write(log, "LIDAR_POINTS", lidar, 1'000'000 + packet);
    }
  }
  EXPECT_THAT(read_run_log(file).lost_by_recorder, ElementsAre(Pair("LIDAR_POINTS", 3)));
}

TEST(RunLog, ALogThatWasPlayedIntoTheBusIsNoLoss) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "played.lcmlog";
  {
    LogWriter log(file);
    lidar_points_t lidar{};
    for (int i = 0; i < 200; ++i) {
      if (i == 100) continue;  // the one that the recorder missed
      lidar.packet = 5000 + i;
      lidar.utime = 1'700'000'000'000'000 + 1333 * i;
      write(log, "LIDAR_POINTS", lidar, lidar.utime);
      lidar.packet = i;
      lidar.utime -= 3'600'000'000;
      if (i >= 50) write(log, "LIDAR_POINTS", lidar, 1'700'000'000'000'100 + 1333 * i);
    }
  }
  EXPECT_THAT(read_run_log(file).lost_by_recorder, ElementsAre(Pair("LIDAR_POINTS", 1)));
}

TEST(RunLog, SeesWhatTheRecorderMissedOfTheOtherSensors) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "sensor_gaps.lcmlog";
  {
    LogWriter log(file);
    imu_t imu{};
    wheels_t wheels{};
    for (const int number : {40, 41, 45, 46}) {  // one of the three was lost on the wire, says the driver
      imu.sequence = number;
      write(log, "IMU", imu, 1'000'000 + number);
    }
    for (const int number : {0, 1, 2, 4}) {
      wheels.sequence = number;
      write(log, "WHEELS", wheels, 1'000'000 + number);
    }
    service_status_t driver = status("imu", 0, 0, 0);
    driver.counter_name = {"lost.packets", "samples"};
    driver.counter_value = {1, 4};
    write(log, "SERVICE_STATUS", driver, 2'000'000);
  }
  EXPECT_THAT(read_run_log(file).lost_by_recorder, ElementsAre(Pair("IMU", 2), Pair("WHEELS", 1)));
}

}  // namespace
}  // namespace curbstone::evaluate
