#include "tools/evaluate/truth/truth.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <fstream>

#include "tests/temporary_folder.hpp"

namespace curbstone::evaluate::truth {
namespace {

/// The folder of a truth with these poses.
class TruthOf {
 public:
  explicit TruthOf(const std::string& poses) { std::ofstream(folder_ / "poses.csv") << poses; }
  [[nodiscard]] std::string folder() const { return folder_.path(); }

 private:
  test::TemporaryFolder folder_;
};

TEST(Truth, ReadsWhatTheSimulatorWrites) {
  const TruthOf written("utime,x,y,z,qw,qx,qy,qz\n1000000000000001,1,2,3,1,0,0,0\n");
  const std::string folder = written.folder();
  std::ofstream(folder + "/curbs.csv") << "line,x,y,z,height,dropped\n4,1,2,0,0.12,1\n";
  std::ofstream(folder + "/truth.json") << R"({"resolution_m": 0.5, "origin": [-1, -2]})";
  const std::uint8_t pixels[6] = {1, 2, 3, 4, 0, 1};
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = 3;
  image.height = 2;
  image.format = PNG_FORMAT_GRAY;
  ASSERT_NE(png_image_write_to_file(&image, (folder + "/classes.png").c_str(), 0, pixels, 0, nullptr), 0);

  const Truth truth = load_truth(folder);
  ASSERT_EQ(truth.poses.size(), 1U);
  EXPECT_EQ(truth.poses[0].utime, 1000000000000001);
  ASSERT_EQ(truth.curbs.size(), 1U);
  EXPECT_TRUE(truth.curbs[0].dropped);
  EXPECT_EQ(truth.classes.at(-0.9, -1.9), 4) << "lower left";
  EXPECT_EQ(truth.classes.at(0.4, -1.1), 3) << "upper right";
  EXPECT_EQ(truth.classes.at(0.6, -1.1), 0) << "outside";
}

TEST(Truth, SaysWhichLineOfWhichFileIsWrong) {
  const TruthOf written("utime,x,y,z,qw,qx,qy,qz\n1,2,3\n");
  try {
    (void)load_truth(written.folder());
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("poses.csv:2: expected 8 numbers"), std::string::npos) << error.what();
  }
  EXPECT_THROW((void)load_truth("/nonexistent"), std::runtime_error);
}

TEST(Truth, KnowsWhereItKnowsTheGroundOnAllSides) {
  TrueClasses classes;
  classes.width = classes.height = 100;  // 12 m x 12 m; the upper half is known
  classes.pixels.assign(100 * 100, 0);
  std::fill_n(classes.pixels.begin(), 50 * 100, std::uint8_t{1});
  EXPECT_TRUE(classes.known_around(6, 9));
  EXPECT_FALSE(classes.known_around(6, 5.7));
  EXPECT_FALSE(classes.known_around(6, 3));
  EXPECT_FALSE(classes.known_around(0, 9)) << "at the image's edge";
}

/// Road, and a wall from x = 1.5 m on, 3 m x 3 m.
TrueClasses road_and_wall(double resolution) {
  TrueClasses classes;
  classes.resolution = resolution;
  classes.width = classes.height = static_cast<int>(std::lround(3 / resolution));
  classes.pixels.assign(static_cast<std::size_t>(classes.width * classes.height), 1);
  for (std::size_t i = 0; i < classes.pixels.size(); ++i) {
    if ((static_cast<int>(i) % classes.width) * resolution >= 1.5 - 1e-9) classes.pixels[i] = 4;
  }
  return classes;
}

TEST(Truth, TellsTheClassOfAMapsCellByWhatItMeetsHoweverTheGridsLie) {
  constexpr double kCell = 0.12;
  Truth truth;
  truth.classes = road_and_wall(0.12);
  truth.fine_classes = road_and_wall(0.03);
  const auto class_at = [&](double x, double yaw = 0, double slack = 0) {
    Pose T = Pose::Identity();
    T.translation() = Eigen::Vector3d(x, 1.5, 0);
    T.linear() = rotation_from_rpy(0, 0, yaw);
    return truth.class_of_cell(T, Eigen::Vector3d::Zero(), kCell, slack);
  };
  EXPECT_EQ(class_at(1.43), 1);
  EXPECT_EQ(class_at(1.47), 4) << "its last 3 cm are the wall's, though its centre is not";
  EXPECT_EQ(class_at(1.44, 0.785), 4) << "a corner";
  EXPECT_EQ(class_at(1.455, 0, 0.02), 0) << "less than the slack in the wall: neither answer is wrong";
  EXPECT_EQ(class_at(1.40, 0, 0.02), 1);
  EXPECT_EQ(class_at(1.50, 0, 0.02), 4);
  truth.fine_classes = {};
  EXPECT_EQ(class_at(1.47), 1) << "of coarse pixels that at its centre";
}

TEST(Truth, RefusesFineClassesWithoutTheirResolution) {
  const TruthOf written("utime,x,y,z,qw,qx,qy,qz\n1000000000000001,1,2,3,1,0,0,0\n");
  const std::string folder = written.folder();
  std::ofstream(folder + "/truth.json") << R"({"resolution_m": 0.5, "origin": [-1, -2]})";
  const std::uint8_t pixel = 1;
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = image.height = 1;
  image.format = PNG_FORMAT_GRAY;
  for (const char* name : {"/classes.png", "/fine_classes.png"})
    ASSERT_NE(png_image_write_to_file(&image, (folder + name).c_str(), 0, &pixel, 0, nullptr), 0);
  EXPECT_THROW((void)load_truth(folder), std::runtime_error);
  std::ofstream(folder + "/truth.json") << R"({"resolution_m": 0.5, "origin": [-1, -2], "fine_resolution_m": 0.1})";
  EXPECT_EQ(load_truth(folder).fine_classes.resolution, 0.1);
}

TEST(Truth, RefusesPosesThatAreNone) {
  const TruthOf written("utime,x,y,z,qw,qx,qy,qz\n1,0,0,0,0,0,0,0\n");
  EXPECT_THROW((void)load_truth(written.folder()), std::runtime_error);
}

}  // namespace
}  // namespace curbstone::evaluate::truth
