#include "tools/bench/mapping/drives/scan_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/temporary_folder.hpp"

namespace curbstone::bench::mapping::drives {
namespace {

namespace fs = std::filesystem;

/// Two scans of four lasers with eight points each, 10 m away, laser by laser from the top, counter-clockwise.
class ScanFolder : public ::testing::Test {
 protected:
  ScanFolder() {
    fs::create_directories(folder_ / "velodyne");
    for (const char* name : {"000000.bin", "000001.bin"}) {
      std::ofstream out(folder_ / "velodyne" / name, std::ios::binary);
      for (int laser = 0; laser < 4; ++laser) {
        for (int i = 0; i < 8; ++i) {
          const float turn = (static_cast<float>(i) + 0.5F) / 8 * 2 * 3.14159265F;
          const float point[4] = {10 * std::cos(turn), 10 * std::sin(turn), 2.0F - static_cast<float>(laser), 0.5F};
          out.write(reinterpret_cast<const char*>(point), sizeof point);
        }
      }
    }
    std::ofstream(folder_ / "poses.txt") << "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n";
    std::ofstream(folder_ / "times.txt") << "0.0\n0.1\n";
  }
  void add_rings() {
    fs::create_directories(folder_ / "rings");
    for (const char* name : {"000000.bin", "000001.bin"}) {
      std::ofstream out(folder_ / "rings" / name, std::ios::binary);
      for (int i = 0; i < 32; ++i) out.put(static_cast<char>(2 * (i / 8)));
    }
  }
  [[nodiscard]] ScanDrive drive() const {
    return {folder_.path().string(), (folder_ / "poses.txt").string(), (folder_ / "times.txt").string()};
  }
  test::TemporaryFolder folder_;
};

TEST_F(ScanFolder, ASweepBeginsBehindAndItsStampIsInTheMiddle) {
  add_rings();
  const ScanDrive scans = drive();
  const mapper::scan::Scan scan = scans.scan(1);
  EXPECT_EQ(scan.end - scan.start, 100'000);
  EXPECT_EQ(scans.truth()[1].utime, scan.start + 50'000);
  ASSERT_EQ(scan.points.size(), 32U);
  EXPECT_LT(scan.points.front().position.x(), 0);
  EXPECT_GT(scan.points.front().position.y(), 0);  // clockwise: the left side comes first
  for (const mapper::scan::LidarPoint& p : scan.points) {
    const float turn = std::atan2(p.position.y(), p.position.x());
    EXPECT_NEAR(p.time, 0.05F * (1 - turn / 3.14159265F), 1e-5F);
    EXPECT_EQ(p.intensity, 127);
    EXPECT_EQ(p.ring, 2 * std::lround(p.position.z() + 1));
  }
}

TEST_F(ScanFolder, ThinnedScansStillTookATenthOfASecondEach) {
  add_rings();
  std::ofstream(folder_ / "times.txt") << "0.0\n0.3\n";
  ScanDrive scans = drive();
  EXPECT_EQ(scans.scan(1).end - scans.scan(1).start, 100'000);
  EXPECT_EQ(scans.truth()[1].utime, scans.scan(1).start + 50'000);
  scans.set_sweep(0.05);
  EXPECT_EQ(scans.scan(1).end - scans.scan(1).start, 50'000);
  EXPECT_LE(scans.scan(1).points.back().time, 0.05F);
}

TEST_F(ScanFolder, TakesThoseThatAreAskedFor) {
  fs::copy_file(folder_ / "velodyne" / "000000.bin", folder_ / "velodyne" / "000002.bin");
  fs::copy_file(folder_ / "velodyne" / "000000.bin", folder_ / "velodyne" / "000003.bin");
  std::ofstream(folder_ / "poses.txt") << "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n"
                                       << "1 0 0 2 0 1 0 0 0 0 1 0\n1 0 0 3 0 1 0 0 0 0 1 0\n";
  std::ofstream(folder_ / "times.txt") << "0.0\n0.1\n0.2\n0.3\n";
  const auto positions = [&](const ScanDrive::Selection& selection) {
    std::vector<double> out;
    const ScanDrive scans(folder_.path().string(), (folder_ / "poses.txt").string(), (folder_ / "times.txt").string(),
                          selection);
    for (const evaluate::truth::StampedPose& pose : scans.truth()) out.push_back(pose.pose.translation().x());
    return out;
  };
  EXPECT_EQ(positions({.first = 1, .every = 2}), (std::vector<double>{1, 3}));
  EXPECT_EQ(positions({.most = 3}), (std::vector<double>{0, 1, 2}));
  EXPECT_THROW((void)positions({.first = 3}), std::runtime_error);
  EXPECT_THROW((void)positions({.every = 4}), std::runtime_error);
}

TEST_F(ScanFolder, ScansWithoutRingsWerePutRightAlready) {
  const mapper::scan::Scan scan = drive().scan(0);
  EXPECT_EQ(scan.start, scan.end);
  for (const mapper::scan::LidarPoint& p : scan.points) {
    EXPECT_EQ(p.time, 0);
    EXPECT_EQ(p.ring, std::lround(p.position.z() + 1));
  }
}

TEST_F(ScanFolder, SaysWhatIsWrong) {
  EXPECT_THROW(ScanDrive(folder_.path().string(), (folder_ / "none.txt").string(), ""), std::runtime_error);
  add_rings();
  std::ofstream(folder_ / "rings" / "000000.bin") << "abc";
  EXPECT_THROW((void)drive().scan(0), std::runtime_error);
  std::ofstream(folder_ / "velodyne" / "000001.bin") << "abc";
  EXPECT_THROW((void)drive().scan(1), std::runtime_error);
}

TEST_F(ScanFolder, OdometryHasPassedTheEndOfEachScan) {
  add_rings();
  ScanDrive scans = drive();
  std::vector<mapper::scan::OdometrySample> samples;
  for (int i = -10; i < 30; ++i)
    samples.push_back({scans.truth().front().utime + 10'000 * i, Pose::Identity(), true, false});
  scans.add_odometry(samples);
  int revolutions = 0;
  scans.play([&](const mapper::scan::Scan& scan, const mapper::scan::OdometryHistory& odometry) {
    ++revolutions;
    EXPECT_TRUE(odometry.covers(scan.start, scan.end));
  });
  EXPECT_EQ(revolutions, 2);
}

}  // namespace
}  // namespace curbstone::bench::mapping::drives
