#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <curbstone/imu_t.hpp>
#include <curbstone/service_config_t.hpp>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "common/log/log_reader.hpp"
#include "common/log/log_writer.hpp"
#include "tests/stamps.hpp"
#include "tests/system/run_program.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::system_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using test::kStart;

class BadLogs : public ::testing::Test {
 protected:
  /// A log of IMU messages each 10 ms, in which the one in the middle has this time.
  void write(int count, std::int64_t middle) {
    LogWriter log(log_);
    for (int i = 0; i < count; ++i) {
      imu_t message{};
      message.utime = i == count / 2 ? middle : kStart + i * 10'000;
      std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
      message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
      log.write("IMU", bytes.data(), static_cast<int>(bytes.size()));
    }
  }
  [[nodiscard]] ProgramResult replay() const {
    return run_program("curbstone replay " + log_ + " --map " + (folder_ / "map.db").string(), 60);
  }

  test::TemporaryFolder folder_;
  std::string log_ = folder_ / "drive.lcmlog";
};

TEST_F(BadLogs, AMessageOfAnImpossibleTimeIsCountedAndLeftOut) {
  for (const std::int64_t utime : {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min(),
                                   std::int64_t{0}, std::int64_t{-5}}) {
    std::filesystem::remove(log_);
    write(300, utime);
    const ProgramResult result = replay();
    EXPECT_EQ(result.exit_status, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("refused.time 1")) << utime;
  }
}

TEST_F(BadLogs, MessagesOfAnotherTypeAreCountedAndMakeNoMap) {
  write(300, kStart);
  ASSERT_EQ(replay().exit_status, 0);
  const auto bytes_of_map = std::filesystem::file_size(folder_ / "map.db");
  std::filesystem::remove(log_);
  const auto write_foreign = [this](bool with_ours) {
    LogWriter log(log_);
    for (int i = 0; i < 300; ++i) {
      const std::int64_t utime = kStart + i * 10'000;
      imu_t message{};
      message.utime = utime;
      std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
      message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
      log.write("LIDAR_POINTS", bytes.data(), static_cast<int>(bytes.size()), utime);
      if (with_ours) log.write("IMU", bytes.data(), static_cast<int>(bytes.size()) - (i % 3 == 0 ? 5 : 0), utime);
    }
  };
  write_foreign(true);
  const ProgramResult result = replay();
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("refused.type 300: messages on LIDAR_POINTS"));
  EXPECT_THAT(result.out, HasSubstr("refused.undecodable 100")) << "those that are cut short";

  write_foreign(false);
  const ProgramResult none = replay();
  EXPECT_EQ(none.exit_status, 1) << none.out;
  EXPECT_THAT(none.err, HasSubstr("holds no LIDAR_POINTS, IMU or WHEELS of a type that this version knows"));
  EXPECT_EQ(std::filesystem::file_size(folder_ / "map.db"), bytes_of_map) << "the map that was there stays";
}

TEST_F(BadLogs, ALeapOfYearsEndsAndTheRestIsRead) {
  write(300, kStart + 1'000'000'000'000'000);
  const ProgramResult result = replay();
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("300 messages"));
}

TEST_F(BadLogs, DamageInTheMiddleIsSaidAndTheExitStatusIsNotZero) {
  write(3000, kStart);
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(log_));
  {
    std::fstream file(log_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(size / 2);
    file << std::string(64, 'x');
  }
  const ProgramResult result = replay();
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.err, HasSubstr("damaged at 1 place: "));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "map.db")) << "what could be read is kept";
}

TEST_F(BadLogs, ALogThatWasCutOffIsReadToItsEnd) {
  write(300, kStart + 150 * 10'000);
  std::filesystem::resize_file(log_, std::filesystem::file_size(log_) - 7);
  const ProgramResult result = replay();
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("cut off"));
}

/// How a log says that a drive was configured.
class RecordedConfigs : public BadLogs {
 protected:
  void write_with_config(const std::string& yaml) {
    service_config_t config;
    config.utime = kStart;
    config.service = config.section = "mapper";
    config.host = "ugv";
    config.version = "0.0.1";
    config.yaml = yaml;
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(config.getEncodedSize()));
    config.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    LogWriter log(log_);
    log.write("CONFIG", bytes.data(), static_cast<int>(bytes.size()));
    imu_t message{};
    bytes.resize(static_cast<std::size_t>(message.getEncodedSize()));
    for (message.utime = kStart; message.utime < kStart + 3'000'000; message.utime += 10'000) {
      message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
      log.write("IMU", bytes.data(), static_cast<int>(bytes.size()));
    }
  }
  [[nodiscard]] ProgramResult replay_with(const std::string& arguments) const {
    return run_program("curbstone replay " + log_ + " --map " + (folder_ / "map.db").string() + " " + arguments, 60);
  }
};

TEST_F(RecordedConfigs, AReplayRunsWithWhatWasRecorded) {
  write_with_config("mapper:\n  vehicle:\n    lidar: [0, 0, 1.5, 0, 0, 0]\n");
  const ProgramResult result = replay();
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("configuration: as recorded by 0.0.1"));
  EXPECT_THAT(result.err, Not(HasSubstr("mapper.vehicle.lidar")));
  EXPECT_THAT(result.err, HasSubstr("mapper was recorded by version 0.0.1, this is "));
}

TEST_F(RecordedConfigs, WhatIsRecordedOfTheVehicleHoldsForTheProcessesThatAreNot) {
  write_with_config("mapper:\n  vehicle:\n    wheel_radius: 0.3\n");
  const std::string all = (folder_ / "all.lcmlog").string();
  const ProgramResult result = replay_with("--record " + all);
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out,
              HasSubstr("as recorded by 0.0.1; ekf, tensor_voting, semantic_map: the recorded vehicle, else "
                        "the defaults, as none is recorded"));
  LogReader reader(all);
  std::string ekf;
  service_config_t config;
  while (const auto event = reader.next()) {
    if (event->channel == "CONFIG" &&
        config.decode(event->bytes.data(), 0, static_cast<int>(event->bytes.size())) > 0 && config.section == "ekf")
      ekf = config.yaml;
  }
  EXPECT_THAT(ekf, HasSubstr("wheel_radius: 0.3 "));
}

TEST_F(RecordedConfigs, AnotherConfigurationIsTakenAndItsDifferencesAreNamed) {
  write_with_config("mapper:\n  vehicle:\n    lidar: [0, 0, 1.5, 0, 0, 0]\n");
  const std::string config = (folder_ / "ugv.yaml").string();
  std::ofstream(config) << "vehicle:\n  lidar: [0, 0, 2.5, 0, 0, 0]\n";
  const ProgramResult result = replay_with("--config " + config);
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("configuration: " + config));
  EXPECT_THAT(result.err, HasSubstr("mapper.vehicle.lidar: [0, 0, 2.5, 0, 0, 0], recorded with [0, 0, 1.5, 0, 0, 0]"));
}

TEST_F(RecordedConfigs, OneThatThisVersionCannotReadIsAnErrorWithAWayOut) {
  write_with_config("mapper:\n  no_such_key: 1\n");
  const ProgramResult result = replay();
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.err, HasSubstr("--config FILE"));
}

}  // namespace
}  // namespace curbstone::system_test
