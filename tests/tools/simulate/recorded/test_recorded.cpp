#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/simulate/devices/rs16_emulator.hpp"
#include "tools/simulate/recorded/laser_scale.hpp"
#include "tools/simulate/recorded/level.hpp"
#include "tools/simulate/recorded/recorded_motion.hpp"
#include "tools/simulate/recorded/scan_rings.hpp"
#include "tools/simulate/recorded/scan_surroundings.hpp"
#include "tools/simulate/sensors/lidar_model.hpp"

namespace curbstone::simulate::recorded {
namespace {

TEST(Playback, StandsGetsGoingAndKeepsThePace) {
  const recorded::Playback playback(4, 3);
  EXPECT_EQ(playback.recording_time(3.9), 0);
  EXPECT_DOUBLE_EQ(playback.recording_time(8) - playback.recording_time(7.5), 0.5);
  for (const double recorded : {2.0, 5.0})
    EXPECT_NEAR(playback.recording_time(playback.drive_time(recorded)), recorded, 1e-12);
  for (double t = 4; t < 7; t += 0.01)
    EXPECT_LE(playback.recording_time(t + 0.01) - playback.recording_time(t), 0.0101);
}

struct Scanner {
  int beams;
  double top, bottom;   // deg
  double azimuth_step;  // deg
  bool swept;           // each point seen from where the vehicle was when the head, clockwise, looked there
};
constexpr Scanner kDense{64, 2.0, -24.8, 0.18, false};
constexpr Scanner kSparse{16, 15.1, -14.9, 0.36, true};

/// A made-up recording: a level ground 1.73 m below the lidar, a wall at y = 6 and one at x = -8, seen by a scanner
/// that moves straight ahead at 5 m/s.
class MadeUpRecording : public ::testing::Test {
 protected:
  void SetUp() override { record(kDense); }
  void record(const Scanner& scanner) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    if (scanner.swept) {
      std::filesystem::create_directories(folder_ + "/rings");
      std::filesystem::create_directories(folder_ + "/velodyne");
    }
    std::ofstream poses(folder_ + "/poses.txt");
    for (int k = 0; k < 12; ++k) {
      poses << "1 0 0 " << 0.5 * k << " 0 1 0 0 0 0 1 0\n";
      std::ofstream scan(folder_ + (scanner.swept ? "/velodyne/" : "/") + std::to_string(100 + k) + ".bin",
                         std::ios::binary);
      for (int beam = 0; beam < scanner.beams; ++beam) {
        const double elevation =
            (scanner.top + (scanner.bottom - scanner.top) * beam / (scanner.beams - 1)) * M_PI / 180;
        for (double azimuth = -180; azimuth < 180; azimuth += scanner.azimuth_step) {
          const double a = azimuth * M_PI / 180;
          const double x = 0.5 * k - (scanner.swept ? 0.5 * azimuth / 360 : 0.0);
          const Eigen::Vector3d d(std::cos(elevation) * std::cos(a), std::cos(elevation) * std::sin(a),
                                  std::sin(elevation));
          double range = 1e9;
          if (d.z() < -1e-3) range = -1.73 / d.z();
          if (d.y() > 1e-3) range = std::min(range, 6.0 / d.y());
          if (d.x() < -1e-3) range = std::min(range, (-8.0 - x) / d.x());
          if (range > 60) continue;
          const Eigen::Vector4f record(static_cast<float>(range * d.x()), static_cast<float>(range * d.y()),
                                       static_cast<float>(range * d.z()), 0.4F);
          scan.write(reinterpret_cast<const char*>(record.data()), sizeof record);
        }
      }
    }
  }
  struct Seen {
    int ground = 0, side = 0, back = 0, beams = 0;
  };
  /// What the emulated beams meet; above what a dense recording has seen there must be nothing.
  [[nodiscard]] Seen see_again(bool dense) const {
    const recorded::ScanSet scans = recorded::find_scans(folder_, folder_ + "/poses.txt", "");
    const recorded::Playback playback(1, 1);
    const recorded::RecordedMotion motion(scans, {}, Eigen::Matrix3d::Identity(), playback);
    EXPECT_NEAR(motion.T_world_base(2.0).translation().x(), 2.5, 0.02) << "1.5 s less half of the ramp, at 5 m/s";
    recorded::ScanSurroundings surroundings(scans, motion, playback, devices::Rs16Emulator());
    const devices::Rs16Emulator emulator({.rpm = 600});
    Seen out;
    for (double t = 0.5; t < 2; t += 0.0171) {
      const double azimuth = std::fmod(t * 3600, 360.0), span = 24 * emulator.azimuth_step();
      const Pose T = motion.T_world_base(t) * VehicleConfig{}.T_base_lidar();
      surroundings.prepare({t, T, azimuth * M_PI / 180, span * M_PI / 180});
      const auto rays = emulator.rays(azimuth + 0.5 * span);
      for (int laser = 0; laser < lidar::models::rs16::kLasers; ++laser) {
        const devices::LidarRay& ray = rays[static_cast<std::size_t>(laser)];
        sensors::Shot shot{
            t, laser, std::atan2(-ray.origin.y(), ray.origin.x()), T * ray.origin, T.linear() * ray.direction, 1};
        const devices::LidarShot seen = surroundings.measure(shot);
        if (dense && laser >= 8 && laser < 15) {
          EXPECT_EQ(seen.range_m, 0) << "the recording does not reach up there";
          continue;
        }
        if (laser == 7 || laser == 15 || seen.range_m <= 0) continue;
        ++out.beams;
        const Eigen::Vector3d p = shot.origin_world + static_cast<double>(seen.range_m) * shot.direction_world;
        if (std::abs(p.y() - 6) < 0.03 && p.z() > 0.0)
          ++out.side;
        else if (std::abs(p.x() + 8) < 0.03 && p.z() > 0.0)
          ++out.back;
        else if (std::abs(p.z()) < 0.02)
          ++out.ground;
      }
    }
    return out;
  }
  test::TemporaryFolder temporary_;
  std::string folder_ = temporary_ / "scans";
};

TEST_F(MadeUpRecording, IsFoundReadAndLevel) {
  const recorded::ScanSet scans = recorded::find_scans(folder_, folder_ + "/poses.txt", "");
  EXPECT_EQ(scans.files.size(), 12U);
  EXPECT_NEAR(scans.period(), 0.1, 1e-9) << "10 Hz where no times are given";
  EXPECT_FALSE(scans.swept);
  EXPECT_TRUE(recorded::level(scans, 1.73).isApprox(Eigen::Matrix3d::Identity(), 1e-3));
}

TEST_F(MadeUpRecording, HasItsLasersOnOneScale) {
  for (int k = 0; k < 12; ++k) {  // each laser its own gain, no two roads alike
    const std::string file = folder_ + "/" + std::to_string(100 + k) + ".bin";
    std::vector<Eigen::Vector4f> records(std::filesystem::file_size(file) / sizeof(Eigen::Vector4f));
    std::fstream scan(file, std::ios::binary | std::ios::in | std::ios::out);
    scan.read(reinterpret_cast<char*>(records.data()),
              static_cast<std::streamsize>(records.size() * sizeof(Eigen::Vector4f)));
    std::vector<Eigen::Vector3f> positions;
    for (const Eigen::Vector4f& r : records) positions.push_back(r.head<3>());
    const std::vector<std::uint8_t> rings = recorded::rings_of(positions, file);
    for (std::size_t i = 0; i < records.size(); ++i)
      records[i][3] = (0.1F + 0.004F * static_cast<float>(rings[i])) * (0.9F + 0.02F * static_cast<float>(i % 11));
    scan.seekp(0);
    scan.write(reinterpret_cast<const char*>(records.data()),
               static_cast<std::streamsize>(records.size() * sizeof(Eigen::Vector4f)));
  }
  const recorded::ScanSet scans = recorded::find_scans(folder_, folder_ + "/poses.txt", "");
  const recorded::LaserScale scale(scans, 1.73);
  int learned = 0;
  std::map<int, std::vector<int>> road;
  for (const recorded::ScanPoint& point : recorded::read_scan(scans.files[3])) {
    if (std::abs(point.position.z() + 1.73F) < 0.01F && point.position.norm() < 15)
      road[point.laser].push_back(scale.of(point));
  }
  for (auto& [laser, values] : road) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (scale.table().state(static_cast<std::uint8_t>(laser)) != mapper::intensity::RingState::kLearned) continue;
    EXPECT_NEAR(*middle, 64, 5) << laser;
    ++learned;
  }
  EXPECT_GT(learned, 30);
}

TEST_F(MadeUpRecording, IsKnownToBeSweptByItsRingsHoweverTheFolderIsNamed) {
  record(kSparse);
  for (const char* below : {"", "/", "/velodyne", "/velodyne/"})
    EXPECT_TRUE(recorded::find_scans(folder_ + below, folder_ + "/poses.txt", "").swept) << below;
}

TEST_F(MadeUpRecording, IsSeenAgainFromWhereverTheVehicleIs) {
  const Seen seen = see_again(true);
  EXPECT_GT(seen.side, 100);
  EXPECT_GT(seen.back, 20);
  EXPECT_GT(seen.ground, 250);
  EXPECT_GT(seen.side + seen.back + seen.ground, seen.beams * 97 / 100) << "of " << seen.beams;
}

TEST_F(MadeUpRecording, IsPutRightForTheMotionOfTheSweep) {
  record(kSparse);
  const Seen seen = see_again(false);
  EXPECT_GT(seen.side, 100);
  EXPECT_GT(seen.back, 100) << "the wrong way round, it is off by up to 0.5 m";
  EXPECT_GT(seen.ground, 250);
  EXPECT_GT(seen.side + seen.back + seen.ground, seen.beams * 93 / 100)
      << "of " << seen.beams;  // a chord cuts the wall's foot
}

TEST_F(MadeUpRecording, WhatIsMissingIsSaid) {
  EXPECT_THROW(recorded::find_scans("/no/such", folder_ + "/poses.txt", ""), std::runtime_error);
  EXPECT_THROW(recorded::find_scans(folder_, folder_ + "/none.txt", ""), std::runtime_error);
  std::ofstream(folder_ + "/short.txt") << "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0\n";
  EXPECT_THROW(recorded::find_scans(folder_, folder_ + "/short.txt", ""), std::runtime_error);
  std::ofstream(folder_ + "/back.txt") << "0\n1\n0.5\n2";
  EXPECT_THROW(recorded::find_scans(folder_, folder_ + "/poses.txt", folder_ + "/back.txt"), std::runtime_error);
  const auto why = [&](const std::string& poses, const std::string& times) -> std::string {
    std::ofstream(folder_ + "/p.txt") << poses;
    std::ofstream(folder_ + "/t.txt") << times;
    try {
      (void)recorded::find_scans(folder_, folder_ + "/p.txt", folder_ + "/t.txt");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  std::string poses, indexed, camera, times, micros;
  for (int i = 0; i < 12; ++i) {
    const std::string pose = fmt::format("1 0 0 {} 0 1 0 0 0 0 1 0.1\r\n", 0.9 * i);
    poses += pose;
    indexed += std::to_string(i) + " " + pose;
    camera += fmt::format("1 0 0 0.1 0 1 0 -0.1 0 0 1 {}\n", 0.9 * i);
    times += fmt::format("{:e}\n", 0.1 * i);
    micros += fmt::format("{}\n", 1'600'000'000'000'000 + 100'000 * i);
  }
  EXPECT_EQ(why(poses, times), "");
  EXPECT_THAT(why(indexed, times), ::testing::HasSubstr("p.txt:1: expected 12 numbers")) << "as in KITTI-360";
  EXPECT_THAT(why("1 0 0 0 0 1 0 0 0 0 2 0\n" + poses, times), ::testing::HasSubstr("p.txt:1: expected 12 numbers"));
  EXPECT_THAT(why(poses + "0 1 2 3 0 0 0 1\n", times), ::testing::HasSubstr("p.txt:13:")) << "as TUM";
  EXPECT_THAT(why(camera, times), ::testing::HasSubstr("a camera's poses"));
  EXPECT_THAT(why(poses, "0.1\n2011-09-26 13:02:25.95\n"), ::testing::HasSubstr("t.txt:2: expected one number"));
  EXPECT_THAT(why(poses, micros), ::testing::HasSubstr("its scans are 100000 s apart; times are in s"));
  std::ofstream(folder_ + "/100.bin", std::ios::binary) << "no scan";
  EXPECT_THROW(recorded::read_scan(folder_ + "/100.bin"), std::runtime_error);
}

TEST(Kitti, DrivesAreFoundAndSmooth) {
  const std::string data = test::data_path("");
  for (const char* name : {"/kitti00", "/kitti0005_rs16"}) {
    if (!std::filesystem::exists(data + name)) GTEST_SKIP() << data << name << " is not there";
    const recorded::ScanSet scans = recorded::find_scans(data + name, data + name + "/reference_poses.txt", "");
    EXPECT_EQ(scans.swept, std::string(name) == "/kitti0005_rs16");
    EXPECT_NEAR(scans.period(), 0.1036, 1e-3);
    const recorded::Playback playback(4, 3);
    const recorded::RecordedMotion motion(scans, {}, recorded::level(scans, 1.73), playback);
    // An IMU on it measures a car's accelerations, not the noise of the poses.
    for (double t = 0; t < playback.drive_time(scans.times.back()); t += 0.05)
      EXPECT_NEAR(motion::inertia_at(motion, Pose::Identity(), t).specific_force.norm(), kGravity, 1.5)
          << name << " " << t;
    // And it stays by the recording's own path.
    for (std::size_t i = 0; i < scans.times.size(); ++i) {
      const Pose T = motion.T_world_first() * scans.T_first_scan[i] * VehicleConfig{}.T_base_lidar().inverse();
      if (scans.times[i] < 1.5) continue;
      EXPECT_LT((motion.T_world_base(playback.drive_time(scans.times[i])).translation() - T.translation()).norm(), 0.06)
          << name << " " << i;
    }
  }
}

}  // namespace
}  // namespace curbstone::simulate::recorded
