#include "common/config/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "common/config/vehicle.hpp"

namespace curbstone {
namespace {

using ::testing::HasSubstr;

constexpr std::array<std::string_view, 3> kSections = {"imu", "ekf", "mapper"};

struct Inner {
  int iterations = 10;
  void visit(ConfigVisitor& v) { v.field("iterations", iterations, {1, 100}, "count"); }
};
struct Example {
  double track_width = 0.6;
  bool enabled = true;
  std::string device = "/dev/ttyUSB0";
  std::string method = "icp";
  std::vector<double> offset = {0, 0, 1};
  Inner inner;
  void visit(ConfigVisitor& v) {
    v.field("track_width", track_width, {0.01, 10}, "m, between the wheels");
    v.field("enabled", enabled, "or not");
    v.field("device", device, "path");
    v.choice("method", method, {"icp", "loam"}, "registration");
    v.field("offset", offset, {-100, 100}, "m");
    v.section("inner", inner, "nested");
  }
};

std::string error_of(const std::string& yaml) {
  ConfigOf<Example> config;
  try {
    parse_config(yaml, "ugv.yaml", "ekf", kSections, config);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(Config, FileOverridesDefaults) {
  ConfigOf<Example> config;
  parse_config("ekf:\n  track_width: 0.8\n  inner: {iterations: 3}\n  offset: [1, 2, 3]\n", "x", "ekf", kSections,
               config);
  EXPECT_EQ(config.value.track_width, 0.8);
  EXPECT_EQ(config.value.inner.iterations, 3);
  EXPECT_EQ(config.value.offset, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(config.value.device, "/dev/ttyUSB0");
}

TEST(Config, ASecondDocumentIsAnError) {
  EXPECT_EQ(error_of("ekf:\n  enabled: true\n---\nekf:\n  enabled: false\n"),
            "ugv.yaml:3: a second YAML document (after ---), which nobody would read");
  EXPECT_EQ(error_of("---\nekf:\n  enabled: true\n---\n"), "");
  EXPECT_EQ(error_of(""), "");
}

TEST(Config, EmptyDocumentsBehindTheFirstAreNone) {
  EXPECT_EQ(error_of("ekf:\n  enabled: true\n...\n...\n---\n# end\n---\n"), "");
}

TEST(Config, AStrayCommaIsAnErrorAndNotDocumentsWithoutEnd) {
  EXPECT_EQ(error_of(", 1]"), "ugv.yaml:1: no YAML from here on");
  EXPECT_EQ(error_of("--- !t ,"), "ugv.yaml:1: no YAML from here on");
}

TEST(Config, ATabIsNamed) {
  EXPECT_EQ(error_of("ekf:\n\tenabled: true\n"), "ugv.yaml:2: illegal map value: indent by spaces, not by a tab");
  EXPECT_EQ(error_of("ekf: {enabled: true"), "ugv.yaml:1: end of map flow not found");
}

TEST(Config, UnknownKeySaysFileLineAndNearestKey) {
  EXPECT_EQ(error_of("ekf:\n  enabled: true\n  trak_width: 1\n"),
            "ugv.yaml:3: ekf.trak_width: unknown key; did you mean track_width?");
  EXPECT_EQ(error_of("ekf:\n  inner:\n    iteration: 1\n"),
            "ugv.yaml:3: ekf.inner.iteration: unknown key; did you mean iterations?");
  EXPECT_EQ(error_of("efk: {}\n"), "ugv.yaml:1: efk: unknown key; did you mean ekf?");
  EXPECT_EQ(error_of("vehicles: {}\n"), "ugv.yaml:1: vehicles: unknown key; did you mean vehicle?");
  EXPECT_THAT(error_of("recorder: {}\n"), HasSubstr("ugv.yaml:1: recorder: unknown key; did you mean "));
}

TEST(Config, AKeyOfAnotherSectionSaysWhereItBelongs) {
  EXPECT_EQ(error_of("ekf:\n  iterations: 3\n"),
            "ugv.yaml:2: ekf.iterations: unknown key; did you mean ekf.inner.iterations?");
  EXPECT_EQ(error_of("ekf:\n  inner: {track_width: 3}\n"),
            "ugv.yaml:2: ekf.inner.track_width: unknown key; did you mean ekf.track_width?");
  struct Wheels {
    double wheel_radius = 0.17;
    void visit(ConfigVisitor& v) { v.field("wheel_radius", wheel_radius, {0.01, 2}, "m"); }
  };
  struct OnAVehicle {
    Wheels vehicle;
    void visit(ConfigVisitor& v) { v.section("vehicle", vehicle, "stands once for all processes"); }
  };
  ConfigOf<OnAVehicle> config;
  try {
    parse_config("ekf: {wheel_radius: 0.2}", "ugv.yaml", "ekf", kSections, config);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "ugv.yaml:1: ekf.wheel_radius: unknown key; did you mean vehicle.wheel_radius?");
  }
}

TEST(Config, WrongValuesSayWhatWasExpected) {
  EXPECT_THAT(error_of("ekf: {track_width: wide}"), HasSubstr("ugv.yaml:1: ekf.track_width: expected a number"));
  EXPECT_THAT(error_of("ekf: {track_width: -1}"), HasSubstr("-1 is not within 0.01 .. 10"));
  EXPECT_THAT(error_of("ekf: {track_width: .nan}"), HasSubstr("is not within"));
  EXPECT_THAT(error_of("ekf: {method: magic}"), HasSubstr("'magic' is not one of icp, loam"));
  EXPECT_THAT(error_of("ekf: {offset: [1, 2]}"), HasSubstr("expected 3 numbers, got 2"));
  EXPECT_THAT(error_of("ekf: 3"), HasSubstr("expected a map"));
  EXPECT_THAT(error_of("ekf: [\n"), HasSubstr("ugv.yaml:"));
  EXPECT_THAT(error_of("ekf: {? [1] : 2}"), HasSubstr("ugv.yaml:1: ekf.?: expected a key that is a word"));
  EXPECT_THAT(error_of("? [ekf]\n: 2"), HasSubstr("ugv.yaml:1: expected the name of a section"));
}

TEST(Config, AKeyThatStandsTwiceIsRefusedWithBothLines) {
  EXPECT_EQ(error_of("ekf:\n  enabled: true\nekf:\n  track_width: 1\n"), "ugv.yaml:3: ekf: stands in line 1 already");
  EXPECT_EQ(error_of("ekf:\n  inner:\n    iterations: 1\n    iterations: 2\n"),
            "ugv.yaml:4: ekf.inner.iterations: stands in line 3 already");
  EXPECT_EQ(error_of("ekf: {}\nmapper: {a: 1, a: 2}\n"), "ugv.yaml:2: mapper.a: stands in line 2 already")
      << "also in a section that is not this process's";
  EXPECT_THAT(error_of("ekf: &a {track_width: 1, inner: *a}"), HasSubstr("ekf.inner.track_width: unknown key"))
      << "a node that holds itself ends";
}

enum class PaintColour { kRed, kGreen };
struct Painted {
  PaintColour colour = PaintColour::kGreen;
  void visit(ConfigVisitor& v) {
    v.choice("colour", colour, {{"red", PaintColour::kRed}, {"green", PaintColour::kGreen}}, "of the paint");
  }
};

TEST(Config, WordsStandForTheValuesOfAnEnumeration) {
  ConfigOf<Painted> config;
  parse_config("ekf: {}", "x", "ekf", kSections, config);
  EXPECT_EQ(config.value.colour, PaintColour::kGreen) << "the default stays";
  EXPECT_THAT(dump_config("ekf", config), HasSubstr("colour: green  # of the paint (red | green)"));
  parse_config("ekf: {colour: red}", "x", "ekf", kSections, config);
  EXPECT_EQ(config.value.colour, PaintColour::kRed);
  EXPECT_THAT(dump_config("ekf", config), HasSubstr("colour: red  #"));
  try {
    parse_config("ekf: {colour: reed}", "x", "ekf", kSections, config);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "x:1: ekf.colour: 'reed' is not one of red, green");
  }
  EXPECT_EQ(config.value.colour, PaintColour::kRed) << "what is refused changes nothing";
}

struct WithVehicle {
  VehicleConfig vehicle;
  bool flag = false;
  void visit(ConfigVisitor& v) {
    v.section("vehicle", vehicle, "shared");
    v.field("flag", flag, "own");
  }
};

TEST(Config, VehicleSectionIsSharedByThoseWhoKnowIt) {
  const std::string yaml = "vehicle: {wheel_radius: 0.3}\nekf: {flag: true}\n";
  ConfigOf<WithVehicle> config;
  parse_config(yaml, "ugv.yaml", "ekf", kSections, config);
  EXPECT_EQ(config.value.vehicle.wheel_radius, 0.3);
  EXPECT_TRUE(config.value.flag);
  ConfigOf<WithVehicle> other;
  parse_config(yaml, "ugv.yaml", "mapper", kSections, other);
  EXPECT_EQ(other.value.vehicle.wheel_radius, 0.3) << "also without a section of its own";
  try {
    parse_config("vehicle:\n  wheel_radius: 9\n", "ugv.yaml", "ekf", kSections, config);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("ugv.yaml:2: vehicle.wheel_radius: 9 is not within")) << "as it stands there";
  }
  ConfigOf<Inner> stranger;
  EXPECT_NO_THROW(parse_config(yaml, "ugv.yaml", "imu", kSections, stranger));
}

TEST(Config, MissingFileIsAnError) {
  ConfigOf<Example> config;
  EXPECT_THROW(load_config("/nonexistent/ugv.yaml", "ekf", kSections, config), ConfigError);
  EXPECT_THROW(load_config("/tmp", "ekf", kSections, config), ConfigError);
}

TEST(Config, DumpIsTakenBack) {
  ConfigOf<Example> config;
  config.value.track_width = 0.123456789;
  config.value.device = "a \"quoted\" path";
  config.value.inner.iterations = 42;
  const std::string dump = dump_config("ekf", config);
  ConfigOf<Example> again;
  parse_config(dump, "dump", "ekf", kSections, again);
  EXPECT_EQ(dump_config("ekf", again), dump);
  EXPECT_EQ(config_hash("ekf", again), config_hash("ekf", config));
  again.value.inner.iterations = 43;
  EXPECT_NE(config_hash("ekf", again), config_hash("ekf", config));
}

TEST(Config, TheHashIsOfTheValuesAndNotOfTheirHelp) {
  struct OtherHelp {
    int iterations = 10;
    void visit(ConfigVisitor& v) { v.field("iterations", iterations, {1, 100}, "how many"); }
  };
  ConfigOf<Inner> inner;
  ConfigOf<OtherHelp> other_help;
  EXPECT_EQ(config_hash("ekf", other_help), config_hash("ekf", inner));
}

TEST(Config, SetReachesNestedKeys) {
  ConfigOf<Example> config;
  set_config_value("inner.iterations=7", config);
  set_config_value("device=/tmp/imu", config);
  EXPECT_EQ(config.value.inner.iterations, 7);
  EXPECT_EQ(config.value.device, "/tmp/imu");
  EXPECT_THROW(set_config_value("inner.iteratons=7", config), ConfigError);
  EXPECT_THROW(set_config_value("nonsense", config), ConfigError);
}

TEST(Config, ASectionTakesItsOwnAssignmentsInTheirOrder) {
  ConfigOf<Example> config;
  set_section_values(
      "ekf", {"ekf.inner.iterations=7", "ekf_other.device=/x", "mapper.nonsense", "ekf.inner.iterations=8"}, config);
  EXPECT_EQ(config.value.inner.iterations, 8);
  EXPECT_EQ(config.value.device, ConfigOf<Example>().value.device);
  EXPECT_THROW(set_section_values("ekf", {"ekf.inner.iteratons=7"}, config), ConfigError);
}

TEST(Config, ATextMayBeEmpty) {
  for (const char* assignment : {"device=", "device=\"\"", "device=''"}) {
    ConfigOf<Example> config;
    set_config_value(assignment, config);
    EXPECT_EQ(config.value.device, "") << assignment;
  }
  ConfigOf<Example> config;
  parse_config("ekf:\n  device:\n", "ugv.yaml", "ekf", kSections, config);
  EXPECT_EQ(config.value.device, "");
}

}  // namespace
}  // namespace curbstone
