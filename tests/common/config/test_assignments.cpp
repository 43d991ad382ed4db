#include "common/config/assignments.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

namespace curbstone {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::array<std::string_view, 2> kProcesses = {"ekf", "mapper"};

TEST(Assignments, OfASectionStayAsTheyAre) {
  EXPECT_THAT(assignments_for(kProcesses, {"ekf.fuse_map=true", "mapper.icp.iterations=20"}),
              ElementsAre("ekf.fuse_map=true", "mapper.icp.iterations=20"));
}

TEST(Assignments, OfTheVehicleAreForEachSection) {
  EXPECT_THAT(assignments_for(kProcesses, {"vehicle.track_width=0.9"}),
              ElementsAre("ekf.vehicle.track_width=0.9", "mapper.vehicle.track_width=0.9"));
}

TEST(Assignments, OfAnotherSectionAreRefusedForTheyWouldChangeNothing) {
  for (const char* const wrong : {"maper.method=loam", "track_width=0.9", "vehicle=1", "semantic_map.map=a.db", ""}) {
    try {
      (void)assignments_for(kProcesses, {wrong});
      FAIL() << wrong;
    } catch (const ConfigError& error) {
      EXPECT_THAT(error.what(), HasSubstr("vehicle or one of ekf, mapper"));
    }
  }
}

}  // namespace
}  // namespace curbstone
