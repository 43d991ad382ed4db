#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <curbstone/imu_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/config/config.hpp"
#include "common/log/log_writer.hpp"
#include "config/sections.hpp"
#include "services/mapper/config/mapper_config.hpp"
#include "tests/damaged_file.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/tools/calibrate/calibration_drive.hpp"
#include "tools/calibrate/calibrate.hpp"
#include "tools/command/run_subcommand.hpp"

namespace curbstone::calibrate {
namespace {

class RunCalibrate : public ::testing::Test {
 protected:
  template <class Message>
  static void write(LogWriter& log, const std::string& channel, const Message& message) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    log.write(channel, bytes.data(), static_cast<int>(bytes.size()));
  }
  /// A log as a mapper whose file is wrong leaves it: it found where the LiDAR was, and put base_link at the wrong
  /// place.
  void write_log(const CalibrationData& data) {
    LogWriter log(log_);
    const Pose T_lidar_base = believed_vehicle().T_base_lidar().inverse();
    std::size_t wheels = 0, lidar = 0;
    for (const ekf::base::ImuSample& s : data.imu) {
      for (; wheels < data.wheels.size() && data.wheels[wheels].utime <= s.utime; ++wheels) {
        wheels_t m{};
        m.utime = data.wheels[wheels].utime;
        m.angle[0] = data.wheels[wheels].angle[0];
        m.angle[1] = data.wheels[wheels].angle[1];
        write(log, "WHEELS", m);
      }
      for (; lidar < data.lidar.size() && data.lidar[lidar].utime <= s.utime; ++lidar) {
        map_pose_t m{};
        m.utime = data.lidar[lidar].utime;
        m.flags = map_pose_t::REGISTERED;
        pose_to_arrays(data.lidar[lidar].T_map_lidar * T_lidar_base, m.map_base_position, m.map_base_orientation);
        write(log, "MAP_POSE", m);
      }
      imu_t m{};
      m.utime = s.utime;
      for (int i = 0; i < 3; ++i) {
        m.angular_rate[i] = s.angular_rate[i];
        m.acceleration[i] = s.acceleration[i];
      }
      write(log, "IMU", m);
    }
  }
  static int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "calibrate");
    std::vector<char*> argv;
    for (std::string& a : arguments) argv.push_back(a.data());
    return command::run_subcommand("calibrate", run_calibrate, static_cast<int>(argv.size()), argv.data());
  }
  void write_config() {
    const VehicleConfig v = believed_vehicle();
    std::ofstream out(config_);
    const auto list = [&](const std::vector<double>& x) {
      for (std::size_t i = 0; i < 6; ++i) out << (i == 0 ? "[" : ", ") << x[i];
      out << "]\n";
    };
    out << "vehicle:\n  wheel_radius: " << v.wheel_radius << "\n  track_width: " << v.track_width << "\n  lidar: ";
    list(v.lidar);
    out << "  imu: ";
    list(v.imu);
  }

  test::TemporaryFolder folder_;
  std::string log_ = folder_ / "drive.lcmlog";
  std::string config_ = folder_ / "ugv.yaml";
};

TEST_F(RunCalibrate, WritesAVehicleSectionThatTheProcessesTakeAndTheSameForPrograms) {
  write_log(drive_to_calibrate(town_motion(), 90.0, 1));
  write_config();
  ASSERT_EQ(run({log_, "--config", config_, "--out", folder_ / "new.yaml", "--json", folder_ / "new.json"}), 0);
  ConfigOf<mapper::config::MapperConfig> loaded;
  load_config(folder_ / "new.yaml", "mapper", kProcessSections, loaded);
  const VehicleConfig& found = loaded.value.vehicle;
  EXPECT_NEAR(found.wheel_radius, true_vehicle().wheel_radius, 0.001 * true_vehicle().wheel_radius);
  EXPECT_NEAR(found.track_width, true_vehicle().track_width, 0.005 * true_vehicle().track_width);
  EXPECT_NEAR(found.lidar[5], true_vehicle().lidar[5], 0.1 * 3.1416 / 180.0);
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(folder_ / "new.json"));
  ASSERT_EQ(json["parameters"].size(), kCalibratedCount);
  EXPECT_EQ(json["covariance"].size(), kCalibratedCount);
  EXPECT_EQ(json["parameters"][2]["name"], "track_width");
  EXPECT_TRUE(json["parameters"][2]["observed"].get<bool>());
}

TEST_F(RunCalibrate, OfADamagedLogItCalibratesFromTheRestAndTheExitStatusTellsPrograms) {
  write_log(drive_to_calibrate(town_motion(), 30.0, 1));
  test::damage_middle(log_, 1000);
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({log_, "--out", folder_ / "new.yaml"}), 1);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr("damaged at 1 place: "));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "new.yaml"));
}

TEST_F(RunCalibrate, SaysWhatALogLacks) {
  CalibrationData data = drive_to_calibrate(town_motion(), 10.0, 1);
  data.lidar.clear();
  write_log(data);
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({log_}), 1);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              ::testing::HasSubstr("holds no LIDAR_POINTS that can be mapped, and no MAP_POSE"));
  EXPECT_EQ(run({folder_ / "nothing.lcmlog"}), 1);
  EXPECT_EQ(run({}), 2);
  EXPECT_EQ(run({log_, "--config", folder_ / "nothing.yaml"}), 2);
}

}  // namespace
}  // namespace curbstone::calibrate
