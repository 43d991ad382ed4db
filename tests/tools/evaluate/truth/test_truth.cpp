#include "tools/evaluate/truth/truth.hpp"

#include <gtest/gtest.h>
#include <png.h>

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
  testing::TemporaryFolder folder_;
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

TEST(Truth, RefusesPosesThatAreNone) {
  const TruthOf written("utime,x,y,z,qw,qx,qy,qz\n1,0,0,0,0,0,0,0\n");
  EXPECT_THROW((void)load_truth(written.folder()), std::runtime_error);
}

}  // namespace
}  // namespace curbstone::evaluate::truth
