#include "tools/evaluate/truth/street_labels.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::evaluate::truth {
namespace {

/// A labelled scan of a street along x: road up to y = 4, sidewalk beyond, a step of `step(x)` between them.
template <class Step>
void write_street(const std::string& folder, Step step) {
  namespace fs = std::filesystem;
  fs::create_directories(folder + "/scans");
  fs::create_directories(folder + "/labels");
  std::ofstream(folder + "/reference_poses.txt") << "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n";
  std::ofstream scan(folder + "/scans/000000.bin", std::ios::binary);
  std::ofstream labels(folder + "/labels/000000.label", std::ios::binary);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.01);
  for (double x = -10; x < 10; x += 0.08) {
    for (double y = 1; y < 7; y += 0.08) {
      const bool high = y > 4;
      const double slope = 0.02 * y;  // the crossfall must not be taken for a step
      const std::array<float, 4> point = {static_cast<float>(x), static_cast<float>(y),
                                          static_cast<float>(-1.73 + slope + (high ? step(x) : 0) + noise(random)), 0};
      const std::uint32_t label = high ? 48 : 40;
      scan.write(reinterpret_cast<const char*>(point.data()), sizeof point);
      labels.write(reinterpret_cast<const char*>(&label), sizeof label);
    }
  }
}

template <class Step>
StreetLabels labels_of_street(Step step, const Pose& T_world_first = Pose::Identity()) {
  const test::TemporaryFolder folder;
  write_street(folder.path(), step);
  return read_street_labels(folder.path(), T_world_first);
}

TEST(StreetLabels, FindTheCurbAndItsHeight) {
  const auto labels = labels_of_street([](double) { return 0.10; });
  ASSERT_GT(labels.curbs.size(), 100U);
  for (const TrueCurbPoint& point : labels.curbs) {
    EXPECT_NEAR(point.y, 4.0, 0.05);
    EXPECT_NEAR(point.height, 0.10, 0.015);
    EXPECT_FALSE(point.dropped);
  }
  EXPECT_EQ(labels.classes.at(0, 2), 1);
  EXPECT_EQ(labels.classes.at(0, 6), 1);
  EXPECT_EQ(labels.classes.at(labels.curbs[50].x, labels.curbs[50].y), 2);
  EXPECT_TRUE(labels.classes.known_around(0, 4));
  EXPECT_FALSE(labels.classes.known_around(0, -2));
}

TEST(StreetLabels, ALowStepDoesNotCount) {
  const auto labels = labels_of_street([](double x) { return x < 0 ? 0.02 : 0.08; });
  int low = 0;
  for (const TrueCurbPoint& point : labels.curbs) {
    if (std::abs(point.x) < 1) continue;
    EXPECT_EQ(point.dropped, point.x < 0) << point.x << " " << point.height;
    low += point.dropped ? 1 : 0;
  }
  EXPECT_GT(low, 50);
}

/// Moves the labels' numbers by 100, as another data set may have them.
void relabel(const std::string& folder) {
  std::fstream file(folder + "/labels/000000.label", std::ios::binary | std::ios::in | std::ios::out);
  std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  for (std::size_t i = 0; i < bytes.size(); i += 4) bytes[i] = static_cast<char>(bytes[i] + 100);
  file.seekp(0);
  file << bytes;
}

TEST(StreetLabels, AnotherDataSetsLabelsAreNamedInATable) {
  const test::TemporaryFolder folder;
  write_street(folder.path(), [](double) { return 0.10; });
  relabel(folder.path());
  EXPECT_TRUE(read_street_labels(folder.path(), Pose::Identity()).curbs.empty());
  std::ofstream(folder.path() / "labels.csv") << "label,surface\n# of our own\n140,road\r\n148,sidewalk\n";
  EXPECT_GT(read_street_labels(folder.path(), Pose::Identity()).curbs.size(), 100U);
}

TEST(StreetLabels, ATableThatMakesNoSenseIsNamedWithItsLine) {
  const test::TemporaryFolder folder;
  write_street(folder.path(), [](double) { return 0.10; });
  for (const std::string row : {"140,street", "x,road", "140", "70000,road"}) {
    std::ofstream(folder.path() / "labels.csv") << "label,surface\n" << row << "\n";
    try {
      (void)read_street_labels(folder.path(), Pose::Identity());
      ADD_FAILURE() << row;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("labels.csv:2"), std::string::npos) << error.what();
    }
  }
}

TEST(StreetLabels, PosesAreTwelveNumbersALine) {
  const test::TemporaryFolder folder;
  write_street(folder.path(), [](double) { return 0.10; });
  for (const char* row : {"0 1 0 0 0 0 1 0 0 0 0 1 0\n", "1 0 0\n", "1 0 0 0 0 1 0 0 0 0 3 0\n"}) {
    std::ofstream(folder / "reference_poses.txt") << "1 0 0 0 0 1 0 0 0 0 1 0\r\n\n" << row;
    try {
      (void)read_street_labels(folder.path(), Pose::Identity());
      ADD_FAILURE() << row;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("reference_poses.txt:3: expected 12"), std::string::npos)
          << error.what();
    }
  }
}

TEST(StreetLabels, OneScanAloneNeedsNoPoseAndMayHaveAnyName) {
  const test::TemporaryFolder folder;
  write_street(folder.path(), [](double) { return 0.10; });
  std::filesystem::remove(folder.path() / "reference_poses.txt");
  std::filesystem::rename(folder.path() / "scans/000000.bin", folder.path() / "scans/mine.bin");
  std::filesystem::rename(folder.path() / "labels/000000.label", folder.path() / "labels/mine.label");
  EXPECT_GT(read_street_labels(folder.path(), Pose::Identity()).curbs.size(), 100U);
  std::filesystem::copy(folder.path() / "labels/mine.label", folder.path() / "labels/other.label");
  EXPECT_THROW((void)read_street_labels(folder.path(), Pose::Identity()), std::runtime_error);
}

TEST(StreetLabels, KnowWhereTwoSurfacesMeet) {
  const auto labels = labels_of_street([](double) { return 0.10; });
  EXPECT_EQ(labels.border_at(0, 4, 0, 1), Border::kSomewhere);
  EXPECT_EQ(labels.border_at(0, 2.5, 0, 1), Border::kNone);
  EXPECT_EQ(labels.border_at(0, 1, 0, 1), Border::kNotKnown);
  EXPECT_EQ(labels.border_at(0, -5, 0, 1), Border::kNotKnown);
}

TEST(StreetLabels, LieInTheTruthsFrame) {
  Pose T_world_first = Pose::Identity();
  T_world_first.linear() = rotation_from_rpy(0, 0, 1.5707963267948966);
  T_world_first.translation() = Eigen::Vector3d(100, 50, 1.73);
  const auto labels = labels_of_street([](double) { return 0.10; }, T_world_first);
  for (const TrueCurbPoint& point : labels.curbs) EXPECT_NEAR(point.x, 96.0, 0.05);
}

TEST(StreetLabels, SayWhatIsWrong) {
  EXPECT_THROW((void)read_street_labels("/nowhere", Pose::Identity()), std::runtime_error);
  const test::TemporaryFolder temporary;
  const std::string folder = temporary.path();
  write_street(folder, [](double) { return 0.1; });
  std::filesystem::resize_file(folder + "/labels/000000.label", 400);
  EXPECT_THROW((void)read_street_labels(folder, Pose::Identity()), std::runtime_error);
  std::filesystem::resize_file(folder + "/labels/000000.label", 401);
  EXPECT_THROW((void)read_street_labels(folder, Pose::Identity()), std::runtime_error);
}

/// kitti00: curbs_on_real_scans.md gives the heights of its steps: 2.2, 3.7 and 4.7 cm at 25, 50 and 75 %.
TEST(StreetLabels, GiveTheStepsOfARecordedStreet) {
  const std::string folder = test::data_path("kitti00");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  Pose T_world_first = Pose::Identity();
  T_world_first.translation().z() = 1.73;
  const auto labels = read_street_labels(folder, T_world_first);
  std::vector<double> steps;
  for (const TrueCurbPoint& point : labels.curbs) {
    if (point.height != 0) steps.push_back(point.height);
  }
  ASSERT_GT(steps.size(), 200U);
  std::sort(steps.begin(), steps.end());
  // Those are of the points where scan lines cross the curb; ours are even along it, and the low kerbs are the long
  // ones.
  EXPECT_NEAR(steps[steps.size() / 4], 0.022, 0.012);
  EXPECT_NEAR(steps[steps.size() / 2], 0.037, 0.012);
  EXPECT_NEAR(steps[steps.size() * 3 / 4], 0.047, 0.012);
}

}  // namespace
}  // namespace curbstone::evaluate::truth
