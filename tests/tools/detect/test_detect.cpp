#include "tools/command/run_subcommand.hpp"
#include "tools/detect/detect.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "tests/temporary_folder.hpp"
#include "tools/detect/cloud_file.hpp"

namespace curbstone::detect {
namespace {

namespace fs = std::filesystem;

class DetectTest : public ::testing::Test {
 protected:
  /// A road with a 12 cm curb at y = 2, x from -6 to 6.
  static std::vector<Eigen::Vector3f> street() {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> along(-6, 6);
    std::normal_distribution<float> noise(0, 0.01F);
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 36'000; ++i) {
      const float x = along(random);
      const float y = along(random);
      points.emplace_back(x, y, (y > 2 ? 0.12F : 0.0F) - 1.7F + noise(random));
    }
    return points;
  }
  fs::path write_kitti(const std::string& name, const std::vector<Eigen::Vector3f>& points) const {
    std::ofstream out(folder_ / name, std::ios::binary);
    for (const Eigen::Vector3f& p : points) {
      const float row[4] = {p.x(), p.y(), p.z(), 0};
      out.write(reinterpret_cast<const char*>(row), sizeof row);
    }
    return folder_ / name;
  }
  fs::path write_text(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  struct Result {
    int status = 0;
    std::string error;
  };
  Result detect(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "detect");
    arguments.insert(arguments.end(), {"--out", (folder_ / "out").string()});
    std::vector<char*> argv;
    for (std::string& a : arguments) argv.push_back(a.data());
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    Result result;
    result.status = command::run_subcommand("detect", run_detect, static_cast<int>(argv.size()), argv.data());
    ::testing::internal::GetCapturedStdout();
    result.error = ::testing::internal::GetCapturedStderr();
    return result;
  }
  std::size_t num_outputs() const {
    if (!fs::exists(folder_ / "out")) return 0;
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_ / "out"), fs::directory_iterator()));
  }
  void expect_curb_at_2() const {
    std::ifstream in(folder_ / "out" / "curbs.csv");
    std::string line;
    std::getline(in, line);
    EXPECT_EQ(line, "x,y,z,height");
    int count = 0;
    while (std::getline(in, line)) {
      float x = 0;
      float y = 0;
      float z = 0;
      float height = 0;
      ASSERT_EQ(std::sscanf(line.c_str(), "%f,%f,%f,%f", &x, &y, &z, &height), 4) << line;
      EXPECT_NEAR(y, 2, 0.12F);
      EXPECT_NEAR(z, -1.7F, 0.05F);
      EXPECT_NEAR(height, 0.12F, 0.03F);
      ++count;
    }
    EXPECT_GT(count, 60);
  }
  test::TemporaryFolder folder_;
};

TEST_F(DetectTest, FindsTheCurbOfAKittiScanAndWritesAllThree) {
  EXPECT_EQ(detect({write_kitti("scan.bin", street()).string()}).status, 0);
  expect_curb_at_2();
  EXPECT_EQ(num_outputs(), 3U);
  EXPECT_GT(fs::file_size(folder_ / "out" / "scan.png"), 500U);
  // The labelled cloud is a cloud again.
  EXPECT_EQ(detect({(folder_ / "out" / "scan_labelled.pcd").string()}).status, 0);
  expect_curb_at_2();
}

TEST_F(DetectTest, DrawsAPictureOfEveryStepOnRequest) {
  const fs::path steps = folder_ / "steps";
  EXPECT_EQ(detect({write_kitti("scan.bin", street()).string(), "--steps", steps.string()}).status, 0);
  for (const char* name :
       {"1_stick", "2_normal", "3_road_height", "4_dem", "5_tilt", "6_evidence", "7_filtered", "8_result"})
    EXPECT_GT(fs::file_size(steps / (std::string(name) + ".png")), 500U) << name;
}

TEST_F(DetectTest, ReadsAsciiPcdAndPly) {
  std::string rows;
  const auto points = street();
  for (const Eigen::Vector3f& p : points)
    rows += std::to_string(p.x()) + ' ' + std::to_string(p.y()) + ' ' + std::to_string(p.z()) + '\n';
  const std::string n = std::to_string(points.size());
  EXPECT_EQ(
      detect({write_text("a.pcd", "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + n +
                                      "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA ascii\n" + rows)
                  .string()})
          .status,
      0);
  expect_curb_at_2();
  EXPECT_EQ(
      detect({write_text("a.ply", "ply\nformat ascii 1.0\nelement vertex " + n +
                                      "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + rows)
                  .string()})
          .status,
      0);
  expect_curb_at_2();
}

// UTM coordinates, as CloudCompare writes them: a float32 would round them to half a metre.
TEST_F(DetectTest, AGeoreferencedCloudNeedsAnOriginAndKeepsItsCoordinates) {
  const Eigen::Vector3d utm(458'000.25, 5'429'000.75, 115.5);
  std::string rows;
  const auto points = street();
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p = point.cast<double>() + utm;
    rows += std::to_string(p.x()) + ' ' + std::to_string(p.y()) + ' ' + std::to_string(p.z()) + '\n';
  }
  const fs::path cloud =
      write_text("utm.ply", "ply\nformat ascii 1.0\nelement vertex " + std::to_string(points.size()) +
                                "\nproperty double x\nproperty double y\nproperty double z\nend_header\n" + rows);
  const Result without = detect({cloud.string()});
  EXPECT_EQ(without.status, 1);
  EXPECT_THAT(without.error, ::testing::HasSubstr("--origin 458000,5429000,114"));
  EXPECT_EQ(num_outputs(), 0U);

  const auto read = read_cloud(cloud.string(), utm);
  ASSERT_EQ(read.size(), points.size());
  for (std::size_t i = 0; i < read.size(); i += 100) EXPECT_LT((read[i] - points[i]).norm(), 1e-5F);

  EXPECT_EQ(detect({cloud.string(), "--origin", "458000,5429000,114"}).status, 0);
  std::ifstream in(folder_ / "out" / "curbs.csv");
  std::string line;
  std::getline(in, line);
  int count = 0;
  for (double x = 0, y = 0; std::getline(in, line); ++count) {
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf", &x, &y), 2) << line;
    EXPECT_NEAR(x, utm.x(), 7);
    EXPECT_NEAR(y, utm.y() + 2, 0.12);
  }
  EXPECT_GT(count, 60);
  EXPECT_EQ(detect({cloud.string(), "--origin", "458000,5429000"}).status, 2);
}

TEST_F(DetectTest, ACloudThatSeemsUpsideDownIsNamed) {
  auto cloud = street();
  for (int i = 0; i < 4000; ++i)
    cloud.emplace_back(static_cast<float>(i) * 0.003F - 6, 5, static_cast<float>(i % 100) * 0.08F - 1.7F);
  EXPECT_EQ(detect({write_kitti("up.bin", cloud).string()}).error, "");
  for (Eigen::Vector3f& p : cloud) p.z() = -p.z();
  EXPECT_THAT(detect({write_kitti("down.bin", cloud).string()}).error, ::testing::HasSubstr("needs z up"));
}

TEST_F(DetectTest, PutsAFolderOfScansTogetherByTheirPoses) {
  fs::create_directories(folder_ / "scans");
  auto near = street();
  std::vector<Eigen::Vector3f> moved;
  for (const Eigen::Vector3f& p : near) moved.emplace_back(p.x() - 1, p.y(), p.z());
  write_kitti("scans/000000.bin", near);
  write_kitti("scans/000001.bin", moved);
  const auto poses = write_text("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n");
  EXPECT_EQ(detect({(folder_ / "scans").string(), "--poses", poses.string()}).status, 0);
  expect_curb_at_2();
  const auto bad = write_text("bad.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 2 3\n");
  EXPECT_THAT(detect({(folder_ / "scans").string(), "--poses", bad.string()}).error, ::testing::HasSubstr("bad.txt:2"));
  const auto indexed =
      write_text("indexed.txt", "0 1 0 0 0 0 1 0 0 0 0 1 0\n1 1 0 0 1 0 1 0 0 0 0 1 0\n");  // KITTI-360
  EXPECT_THAT(detect({(folder_ / "scans").string(), "--poses", indexed.string()}).error,
              ::testing::HasSubstr("indexed.txt:1: expected 12 numbers"));
  EXPECT_THAT(detect({(folder_ / "scans").string()}).error, ::testing::HasSubstr("--poses"));
}

TEST_F(DetectTest, NumbersInTheNamesOfScansAreCountedNotSpelled) {
  fs::create_directories(folder_ / "scans");
  std::string poses;
  for (int i = 0; i <= 10; ++i) {
    write_kitti("scans/" + std::to_string(i) + ".bin", {{static_cast<float>(i), 0, 0}});
    poses += "1 0 0 0 0 1 0 " + std::to_string(100 * i) + " 0 0 1 0\n";
  }
  const auto cloud = read_cloud_folder((folder_ / "scans").string(), write_text("poses.txt", poses).string());
  ASSERT_EQ(cloud.size(), 11U);
  for (int i = 0; i <= 10; ++i)
    EXPECT_EQ(cloud[static_cast<std::size_t>(i)].y(), 100.0F * cloud[static_cast<std::size_t>(i)].x());
}

TEST_F(DetectTest, PosesMayBeGeoreferenced) {
  fs::create_directories(folder_ / "scans");
  write_kitti("scans/0.bin", street());
  const auto poses = write_text("poses.txt", "1 0 0 458000.25 0 1 0 5429000.75 0 0 1 115.5\n");
  const auto cloud =
      read_cloud_folder((folder_ / "scans").string(), poses.string(), 0, {458'000.25, 5'429'000.75, 115.5});
  ASSERT_EQ(cloud.size(), street().size());
  for (std::size_t i = 0; i < cloud.size(); i += 100) EXPECT_LT((cloud[i] - street()[i]).norm(), 1e-5F);
}

TEST_F(DetectTest, LeavesOutWhatTheRecordingVehicleSeesOfItself) {
  fs::create_directories(folder_ / "scans");
  auto scan = street();
  const std::size_t of_street = scan.size();
  const Eigen::Vector3f bonnet(0.9F, 0, -0.8F);
  scan.push_back(bonnet);
  write_kitti("scans/000000.bin", scan);
  const auto poses = write_text("poses.txt", "1 0 0 5 0 1 0 0 0 0 1 0\n");
  const auto all = read_cloud_folder((folder_ / "scans").string(), poses.string());
  const auto far = read_cloud_folder((folder_ / "scans").string(), poses.string(), 1.5);
  EXPECT_EQ(all.size(), of_street + 1);
  EXPECT_EQ(far.size(), of_street);
}

TEST_F(DetectTest, BadFilesGiveOneLineStatus1AndNoOutput) {
  std::vector<Eigen::Vector3f> nans(100, Eigen::Vector3f::Constant(std::nanf("")));
  const auto whole = write_kitti("cut.bin", street());
  fs::resize_file(whole, 1001);
  const std::string header =
      "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1000\nHEIGHT 1\nPOINTS 1000\nDATA binary\n";
  const std::string files[] = {
      (folder_ / "missing.bin").string(),
      whole.string(),
      write_text("empty.ply", "").string(),
      write_text("hello.pcd", "hello\n").string(),
      write_text("hello.ply", "hello\n").string(),
      write_text("cut.pcd", header + std::string(500, 'x')).string(),
      write_text(
          "huge.pcd",
          "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 999999999999\nHEIGHT 1\nPOINTS 999999999999\nDATA ascii\n")
          .string(),
      write_text("noxyz.pcd",
                 "FIELDS a b\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n1 2\n")
          .string(),
      write_kitti("nans.bin", nans).string(),
      write_text("notes.txt", "hello").string(),
  };
  for (const std::string& file : files) {
    const Result result = detect({file});
    EXPECT_EQ(result.status, 1) << file;
    EXPECT_EQ(std::count(result.error.begin(), result.error.end(), '\n'), 1) << file << ": " << result.error;
    EXPECT_THAT(result.error, ::testing::HasSubstr(fs::path(file).filename().string()));
  }
  EXPECT_EQ(num_outputs(), 0U);
}

TEST_F(DetectTest, RandomDamageToAPcdDoesNoHarm) {
  std::vector<cloud_map::DetectedPoint> points(200);
  const fs::path good = folder_ / "good.pcd";
  write_labelled_pcd(points, good.string());
  std::ifstream in(good, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  std::mt19937 random(1);
  int read = 0;
  for (int i = 0; i < 300; ++i) {
    std::string bad = bytes;
    const bool cut = i % 2 == 0;
    if (cut) bad.resize(random() % bad.size());
    for (int k = 0; k < 4 && bad.size() > 400; ++k)
      bad[400 + random() % (bad.size() - 400)] = static_cast<char>(random());
    try {
      const auto cloud = read_cloud(write_text("bad.pcd", bad).string());
      EXPECT_FALSE(cut) << "round " << i << ": of a file that is cut off nothing is read";
      EXPECT_LE(cloud.size(), points.size());
      EXPECT_TRUE(std::ranges::all_of(cloud, [](const auto& p) { return p.allFinite(); })) << "round " << i;
      ++read;
    } catch (const CloudFileError& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("bad.pcd"));
    }
  }
  EXPECT_GT(read, 0) << "bytes of points may be any";
}

TEST_F(DetectTest, WrongUsageIsStatus2) {
  EXPECT_EQ(detect({}).status, 2);
  EXPECT_EQ(detect({write_kitti("s.bin", street()).string(), "--set", "curb.min_stepp=1"}).status, 2);
}

}  // namespace
}  // namespace curbstone::detect
