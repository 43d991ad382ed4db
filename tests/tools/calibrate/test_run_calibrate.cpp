#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <curbstone/imu_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/service_config_t.hpp>
#include <curbstone/service_status_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/config/config.hpp"
#include "common/log/log_writer.hpp"
#include "config/sections.hpp"
#include "services/mapper/config/mapper_config.hpp"
#include "tests/damaged_file.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/tools/calibrate/calibration_drive.hpp"
#include "tools/calibrate/calibrate.hpp"
#include "tools/command/run_subcommand.hpp"
#include "tools/simulate/simulate.hpp"

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
  void write_log(const CalibrationData& data, bool with_config = false) {
    LogWriter log(log_);
    if (with_config) {
      VehicleConfig recorded = believed_vehicle();
      recorded.middle = 1.3;
      write(log, "CONFIG",
            service_config_t{data.imu.front().utime, "mapper", "mapper", "ugv", "0.0.1",
                             "mapper:\n  vehicle:\n" + vehicle_yaml(recorded, "    ")});
    }
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
  void simulate_town(const std::string& seconds, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"simulate", "--town", "--seconds", seconds, "--log", log_};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    ASSERT_EQ(simulate::run_simulate(static_cast<int>(argv.size()), argv.data()), 0);
  }
  static std::string vehicle_yaml(const VehicleConfig& v, const std::string& indent) {
    std::ostringstream out;
    const auto list = [&](const char* key, const std::vector<double>& x) {
      out << indent << key << ": ";
      for (std::size_t i = 0; i < 6; ++i) out << (i == 0 ? "[" : ", ") << x[i];
      out << "]\n";
    };
    out << indent << "wheel_radius: " << v.wheel_radius << "\n" << indent << "track_width: " << v.track_width << "\n";
    out << indent << "middle: " << v.middle << "\n";
    list("lidar", v.lidar);
    list("imu", v.imu);
    return out.str();
  }
  void write_config(const VehicleConfig& vehicle = believed_vehicle()) {
    std::ofstream(config_) << "vehicle:\n" << vehicle_yaml(vehicle, "  ");
  }
  [[nodiscard]] VehicleConfig calibrated() const {
    ConfigOf<mapper::config::MapperConfig> loaded;
    load_config(folder_ / "new.yaml", "mapper", kProcessSections, loaded);
    return loaded.value.vehicle;
  }

  test::TemporaryFolder folder_;
  std::string log_ = folder_ / "drive.lcmlog";
  std::string config_ = folder_ / "ugv.yaml";
};

TEST_F(RunCalibrate, WritesAVehicleSectionThatTheProcessesTakeAndTheSameForPrograms) {
  write_log(drive_to_calibrate(town_motion(), 90.0, 1));
  write_config();
  ASSERT_EQ(run({log_, "--config", config_, "--out", folder_ / "new.yaml", "--json", folder_ / "new.json"}), 0);
  const VehicleConfig found = calibrated();
  EXPECT_NEAR(found.wheel_radius, true_vehicle().wheel_radius, 0.001 * true_vehicle().wheel_radius);
  EXPECT_NEAR(found.track_width, true_vehicle().track_width, 0.005 * true_vehicle().track_width);
  EXPECT_NEAR(found.lidar[5], true_vehicle().lidar[5], 0.1 * 3.1416 / 180.0);
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(folder_ / "new.json"));
  ASSERT_EQ(json["parameters"].size(), kCalibratedCount);
  EXPECT_EQ(json["covariance"].size(), kCalibratedCount);
  EXPECT_EQ(json["parameters"][2]["name"], "track_width");
  EXPECT_TRUE(json["parameters"][2]["observed"].get<bool>());
}

TEST_F(RunCalibrate, KeepsWhatItDoesNotEstimate) {
  write_log(drive_to_calibrate(town_motion(), 30.0, 1));
  VehicleConfig vehicle = believed_vehicle();
  vehicle.middle = 1.3;
  write_config(vehicle);
  ASSERT_EQ(run({log_, "--config", config_, "--out", folder_ / "new.yaml"}), 0);
  EXPECT_EQ(calibrated().middle, 1.3) << "a section without it would move the vehicle's own box";
}

TEST_F(RunCalibrate, StartsFromTheVehicleThatTheLogRecorded) {
  write_log(drive_to_calibrate(town_motion(), 90.0, 1), true);
  ASSERT_EQ(run({log_, "--out", folder_ / "new.yaml"}), 0);
  EXPECT_NEAR(calibrated().lidar[5], true_vehicle().lidar[5], 0.1 * 3.1416 / 180.0);
  EXPECT_EQ(calibrated().middle, 1.3);
}

/// The second time would else find the error of the first file once more.
TEST_F(RunCalibrate, FindsTheSameAgainFromAFileThatIsRightAlready) {
  write_log(drive_to_calibrate(town_motion(), 90.0, 1), true);
  write_config(true_vehicle());
  ASSERT_EQ(run({log_, "--config", config_, "--out", folder_ / "new.yaml"}), 0);
  EXPECT_NEAR(calibrated().lidar[5], true_vehicle().lidar[5], 0.1 * 3.1416 / 180.0);
}

/// The mapper corrects the mounting by itself, so that its poses do not show the error.
TEST_F(RunCalibrate, DoesNotCallAMountingRightThatTheMapperCorrected) {
  std::ofstream(config_) << "vehicle:\n  lidar: [0, 0, 1.73, 0, 0, 0.2]\n";
  simulate_town("12", {"--config", config_});
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({log_}), 1);
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, ::testing::HasSubstr("the mapper has corrected the mounting of the LiDAR"));
  EXPECT_THAT(said, ::testing::HasSubstr("set its yaw to 0."));
}

TEST_F(RunCalibrate, DoesNotCallAMountingRightThatTheVehiclesMapperCorrected) {
  write_log(drive_to_calibrate(town_motion(), 30.0, 1));
  {
    service_status_t status{};
    status.service = "mapper";
    status.counter_name = {"lidar_turned"};
    status.counter_value = {1};
    status.num_counters = 1;
    LogWriter more(folder_ / "more");
    write(more, "SERVICE_STATUS", status);
  }
  std::ofstream(log_, std::ios::binary | std::ios::app) << std::ifstream(folder_ / "more", std::ios::binary).rdbuf();
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({log_}), 1);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr("calibrate from that with --map-anew"));
}

TEST_F(RunCalibrate, LeavesTheMapOfTheVehicleAlone) {
  const std::string site = folder_ / "site";
  simulate_town("4");
  std::ofstream(config_) << "mapper:\n  folder: " << site << "\n";
  (void)run({log_, "--config", config_});
  EXPECT_FALSE(std::filesystem::exists(site));
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
