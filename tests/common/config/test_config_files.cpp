/// Files as users make them: with other editors, in other countries, with a slip of the hand.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "common/config/config.hpp"
#include "common/config/number_advice.hpp"
#include "common/config/vehicle.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone {
namespace {

using ::testing::HasSubstr;

constexpr std::array<std::string_view, 1> kDriveSections = {"drive"};

struct DriveConfig {
  double radius = 0.17;
  int node = 1;
  bool inverted = false;
  std::vector<double> offset = {0, 0, 1};
  std::string folder = "/var/log";
  void visit(ConfigVisitor& v) {
    v.field("radius", radius, {0.01, 2}, "m, of the wheels");
    v.field("node", node, {1, 127}, "id of the drive");
    v.field("inverted", inverted, "or not");
    v.field("offset", offset, {-100, 100}, "m, of the sensor");
    v.field("folder", folder, "of recordings");
  }
};

std::string complaint_about(const std::string& yaml) {
  ConfigOf<DriveConfig> config;
  try {
    parse_config(yaml, "ugv.yaml", "drive", kDriveSections, config);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

DriveConfig read(const std::string& yaml) {
  ConfigOf<DriveConfig> config;
  parse_config(yaml, "ugv.yaml", "drive", kDriveSections, config);
  return config.value;
}

TEST(ConfigFiles, AWrongNumberIsShownWithWhatToWriteAndItsUnit) {
  EXPECT_EQ(complaint_about("drive:\n  radius: 0,2\n"),
            "ugv.yaml:2: drive.radius: expected a number, not '0,2': write 0.2 (m, of the wheels)");
  EXPECT_EQ(
      complaint_about("drive:\n  radius: 0.2 m\n"),
      "ugv.yaml:2: drive.radius: expected a number, not '0.2 m': only a number, without a unit (m, of the wheels)");
  EXPECT_EQ(complaint_about("drive:\n  radius: 0.2#m\n"),
            "ugv.yaml:2: drive.radius: expected a number, not '0.2#m': a comment needs a space before its # "
            "(m, of the wheels)");
  EXPECT_EQ(complaint_about("drive:\n  radius: [0.2]\n"),
            "ugv.yaml:2: drive.radius: expected a number, not a list (m, of the wheels)");
  EXPECT_EQ(complaint_about("drive:\n  radius:\n"),
            "ugv.yaml:2: drive.radius: expected a number, and nothing stands there (m, of the wheels)");
  EXPECT_EQ(complaint_about("drive:\n  radius: -0.2\n"),
            "ugv.yaml:2: drive.radius: -0.2 is not within 0.01 .. 2 (m, of the wheels)");
  EXPECT_EQ(complaint_about("drive: {inverted: ja}"), "ugv.yaml:1: drive.inverted: expected true or false, not 'ja'");
}

TEST(ConfigFiles, AListIsShownWithItsWrongNumber) {
  EXPECT_EQ(complaint_about("drive:\n  offset: [0, 0, 1.2 m]\n"),
            "ugv.yaml:2: drive.offset: expected a number, not '1.2 m': only a number, without a unit "
            "(m, of the sensor)");
  EXPECT_EQ(complaint_about("drive:\n  offset: [0,0, 0,0, 1,2]\n"),
            "ugv.yaml:2: drive.offset: expected 3 numbers, got 6; decimals take a point, not a comma "
            "(m, of the sensor)");
  EXPECT_EQ(complaint_about("drive:\n  offset: 0 0 1\n"),
            "ugv.yaml:2: drive.offset: expected a list of 3 numbers, not '0 0 1' (m, of the sensor)");
}

TEST(ConfigFiles, DegreesAreNoRadians) {
  ConfigOf<VehicleConfig> config;
  const auto complaint = [&](const std::string& pose) {
    try {
      parse_config("drive: {lidar: " + pose + "}", "ugv.yaml", "drive", kDriveSections, config);
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(complaint("[0, 0, 1.7, 0, 15, 0]"),
            "ugv.yaml:1: drive.lidar: 15 is not within -6.2832 .. 6.2832 (T_base_lidar: x y z in m, roll pitch yaw in "
            "rad)");
  EXPECT_THAT(complaint("[0, 0, 1.7, 0, 0, -90]"), HasSubstr("-90 is not within -6.2832 .. 6.2832"));
  EXPECT_THAT(complaint("[0, 0, 170, 0, 0, 0]"), HasSubstr("170 is not within -20 .. 20"));
  EXPECT_EQ(complaint("[0, -19, 1.7, 3.1416, 0, -4.7124]"), "");
  EXPECT_EQ(config.value.lidar[5], -4.7124);
}

TEST(ConfigFiles, ALeadingZeroIsNoOctalNumberInSecret) {
  EXPECT_EQ(complaint_about("drive: {node: 010}"), "ugv.yaml:1: drive.node: '010' may be octal: write 10");
  EXPECT_EQ(complaint_about("drive: {node: 009}"), "ugv.yaml:1: drive.node: '009' may be octal: write 9");
  EXPECT_EQ(complaint_about("drive: {node: 00}"), "ugv.yaml:1: drive.node: '00' may be octal: write 0");
  EXPECT_EQ(read("drive: {node: 0x1F}").node, 31) << "as ids on CAN are written";
  EXPECT_EQ(read("drive: {radius: 0.25}").radius, 0.25);
  EXPECT_EQ(without_leading_zeros("-012"), "-12");
  EXPECT_EQ(without_leading_zeros("0"), std::nullopt);
}

/// Otherwise a folder of the name "~" is made, which its owner then removes with `rm -r ~`.
TEST(ConfigFiles, APathThatOnlyAShellUnderstandsIsRefused) {
  EXPECT_EQ(complaint_about("drive:\n  folder: ~/logs\n"),
            "ugv.yaml:2: drive.folder: '~/logs' stays as it is, as no shell expands it: write the whole path");
  EXPECT_THAT(complaint_about("drive: {folder: \"$HOME/logs\"}"), HasSubstr("no shell expands it"));
  EXPECT_THAT(complaint_about("drive: {folder: \"${HOME}/logs\"}"), HasSubstr("no shell expands it"));
  EXPECT_EQ(read("drive: {folder: /data/~x$}").folder, "/data/~x$");
}

std::string complaint_about_setting(const std::string& assignment) {
  ConfigOf<DriveConfig> config;
  try {
    set_config_value(assignment, config);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(ConfigFiles, ASettingOfTheCommandLineIsReadLikeALineOfTheFile) {
  EXPECT_EQ(complaint_about_setting("radius=0,2"),
            "--set radius=0,2: radius: expected a number, not '0,2': write 0.2 (m, of the wheels)");
  EXPECT_EQ(complaint_about_setting("radios=0.2"), "--set radios=0.2: radios: unknown key; did you mean radius?");
  EXPECT_NE(complaint_about_setting("folder=/a #b"), "") << "no comment is cut off in secret";
  EXPECT_NE(complaint_about_setting("folder='/a"), "");
  ConfigOf<DriveConfig> config;
  set_config_value("folder=/a's", config);
  EXPECT_EQ(config.value.folder, "/a's");
  set_config_value("folder=/a,/b", config);
  set_config_value("offset=[1, 2, 3]", config);
  EXPECT_EQ(config.value.folder, "/a,/b");
  EXPECT_EQ(config.value.offset, (std::vector<double>{1, 2, 3}));
}

TEST(ConfigFiles, EveryEditorsLineEndsAndMarksAreRead) {
  EXPECT_EQ(read("\xEF\xBB\xBF# comment\r\ndrive:\r\n  radius: 0.3\r\n").radius, 0.3);
  EXPECT_EQ(complaint_about("# comment\r\ndrive:\r\n  radios: 0.3\r\n"),
            "ugv.yaml:3: drive.radios: unknown key; did you mean radius?");
  EXPECT_EQ(read(std::string("\xFF\xFE"
                             "d\0r\0i\0v\0e\0:\0 \0{\0n\0o\0d\0e\0:\0 \0"
                             "7\0}\0",
                             34))
                .node,
            7);
}

TEST(ConfigFiles, ACommentDoesNotSwallowTheFile) {
  EXPECT_EQ(complaint_about("# comment\rdrive:\r  radius: 0.3\r"),
            "ugv.yaml:1: a line ends with a carriage return alone: tr '\\r' '\\n' mends it");
}

TEST(ConfigFiles, ZeroBytesAreDamage) {
  EXPECT_EQ(complaint_about(std::string(4096, '\0')),
            "ugv.yaml:1: nothing but zero bytes, as after a power cut: write the file anew");
  EXPECT_EQ(complaint_about("drive:\n  node: 2\n" + std::string(100, '\0')),
            "ugv.yaml:3: a zero byte: the file is damaged: write it anew");
}

TEST(ConfigFiles, AKeyOutsideOfItsSectionSaysWhereItBelongs) {
  EXPECT_EQ(complaint_about("drive:\nradius: 0.3\n"), "ugv.yaml:2: radius: unknown key; did you mean drive.radius?");
  EXPECT_EQ(complaint_about("drives: {}\n"), "ugv.yaml:1: drives: unknown key; did you mean drive?");
}

TEST(ConfigFiles, AMissingColonOrASlipOfTheIndentationIsSaid) {
  EXPECT_EQ(complaint_about("drive:\n  radius 0.3\n  node: 2\n"),
            "ugv.yaml:3: illegal map value: is it indented as the lines around it, and has the line before its colon?");
  EXPECT_EQ(complaint_about("drive:\n  radius:0.3\n"),
            "ugv.yaml:2: drive: expected a map of keys and values, not 'radius:0.3': a colon needs a space behind it");
}

TEST(ConfigFiles, WhyAFileCannotBeReadIsSaid) {
  const test::TemporaryFolder folder;
  const auto complaint = [&](const std::string& file) {
    ConfigOf<DriveConfig> config;
    try {
      load_config(file, "drive", kDriveSections, config);
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string file = folder / "ugv.yaml";
  EXPECT_EQ(complaint(file), file + ": cannot be read: No such file or directory");
  EXPECT_EQ(complaint(folder / "."), (folder / ".").string() + ": cannot be read: Is a directory");
  std::filesystem::create_symlink("loop.yaml", folder / "loop.yaml");
  EXPECT_THAT(complaint(folder / "loop.yaml"), HasSubstr("cannot be read: Too many levels of symbolic links"));
  std::ofstream(file).close();
  EXPECT_EQ(complaint(file), file + ": is empty");
}

}  // namespace
}  // namespace curbstone
