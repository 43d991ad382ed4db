#include "services/mapper/returns/flat_intensity.hpp"

#include <gmock/gmock.h>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::returns {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class FlatIntensityTest : public ::testing::Test {
 protected:
  FlatIntensityTest() : scan_(drive_.next()) {}
  void check(int scans, std::optional<std::uint8_t> all = {}) {
    scan::Scan scan = scan_;
    for (scan::LidarPoint& point : scan.points) point.intensity = all.value_or(point.intensity);
    for (int i = 0; i < scans; ++i) intensity_.check(scan);
  }
  std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    intensity_.add_faults(faults);
    return faults;
  }
  test::DetectionScans drive_;
  scan::Scan scan_;
  FlatIntensity intensity_;
};

TEST_F(FlatIntensityTest, OneValueForAllIsNamedUntilTheyDifferAgain) {
  check(FlatIntensity::kVaried);
  for (const int value : {0, 255}) {
    check(FlatIntensity::kLooks - 1, static_cast<std::uint8_t>(value));
    EXPECT_THAT(faults(), IsEmpty()) << "not yet";
    check(1, static_cast<std::uint8_t>(value));
    ASSERT_EQ(faults().size(), 1U);
    EXPECT_THAT(faults()[0], HasSubstr("the intensity of every return is " + std::to_string(value)));
    check(FlatIntensity::kLooks);
    EXPECT_THAT(faults(), IsEmpty());
  }
  EXPECT_EQ(intensity_.counters()["faults.lidar.intensity"], 2);
}

TEST_F(FlatIntensityTest, ADeviceThatMeasuresNoneIsSound) {
  check(500, 0);
  EXPECT_THAT(faults(), IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::returns
