// Drives whose sensors are as they should be: no wheel is called faulty, or not for long, no gyro's axis is done
// without, no leap of its bias is seen, and the vertical force is used. One run of the filter is asked for all of it.
#include <gtest/gtest.h>

#include "services/ekf/filter/filter.hpp"
#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/harmless_drives.hpp"
#include "tests/services/ekf/real_drives.hpp"

namespace curbstone::ekf::filter {
namespace {

struct Verdicts {
  std::int64_t faults = 0, withheld = 0;
  std::int64_t gyro_leaps = 0, vertical_force = 0;
  bool without_axis = false;  // of the gyro, at the end or some time
  double trusted_at = 0.0;    // s, when the last wheel was trusted again
  bool faulty_at_end = false;
};

Verdicts verdicts_on(const base::EkfConfig& config, const Drive& drive) {
  Filter filter(config);
  Verdicts v;
  std::vector<model::Estimate> out;
  std::size_t w = 0;
  bool faulty = false;
  for (const base::ImuSample& imu : drive.imu) {
    for (; w < drive.wheels.size() && drive.wheels[w].utime <= imu.utime; ++w) filter.add(drive.wheels[w], out);
    filter.add(imu, out);
    const bool before = std::exchange(faulty, filter.wheel_watch().faulty(0) || filter.wheel_watch().faulty(1));
    if (before && !faulty) v.trusted_at = base::seconds_between(drive.imu.front().utime, imu.utime);
  }
  Counters counters = filter.counters();
  v.faults = counters["faults.wheel_left"] + counters["faults.wheel_right"];
  v.withheld = counters["withheld.wheel_left"] + counters["withheld.wheel_right"];
  v.faulty_at_end = faulty;
  v.gyro_leaps = counters["gyro_leaps"];
  v.vertical_force = counters["faults.vertical_force"];
  v.without_axis = filter.axes().any();
  for (const char* axis : {"x", "y", "z"})
    v.without_axis = v.without_axis || counters.values().count(std::string("faults.gyro_") + axis) > 0;
  return v;
}

class HarmlessDrives : public ::testing::TestWithParam<HarmlessDrive> {};

/// On ice, on a jack, with stamps that jitter or measures that are wrong.
TEST_P(HarmlessDrives, CallNoWheelAndNoGyroFaulty) {
  const Verdicts v = verdicts_on(base::EkfConfig(), GetParam().make());
  EXPECT_FALSE(v.without_axis);
  EXPECT_EQ(v.gyro_leaps, 0);
  EXPECT_EQ(v.vertical_force, 0);
  if (GetParam().spin_ends < 0) {
    EXPECT_EQ(v.faults, 0);
    EXPECT_EQ(v.withheld, 0);
    return;
  }
  EXPECT_LE(v.faults, 2);  // while it spins nobody can tell
  EXPECT_LT(v.trusted_at, GetParam().spin_ends + 6.0);
  EXPECT_FALSE(v.faulty_at_end);
}
INSTANTIATE_TEST_SUITE_P(All, HarmlessDrives, ::testing::ValuesIn(harmless_drives()), [](const auto& of) {
  std::string name;
  for (const char c : of.param.name) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
});

/// As recorded, with the measures that fit it, and with wrong ones.
class RealDrives : public ::testing::TestWithParam<std::string> {};

TEST_P(RealDrives, CallNoWheelFaultyAndSeeNoLeapOfTheGyro) {
  const auto drive = real_drive(GetParam());
  if (!drive) GTEST_SKIP() << "the recording is not there";
  for (const double radius : {0.9, 1.0, 1.1}) {
    for (const double track : {0.4, 0.8, 1.0, 1.2}) {
      base::EkfConfig config;
      config.vehicle = drive->vehicle;
      config.vehicle.wheel_radius *= radius;
      config.vehicle.track_width *= track;
      const Verdicts v = verdicts_on(config, drive->drive);
      EXPECT_EQ(v.faults, 0) << "radius " << radius << ", track " << track;
      EXPECT_EQ(v.withheld, 0);
      EXPECT_EQ(v.vertical_force, 0);
      if (radius == 1.0 && track == 1.0) {
        EXPECT_EQ(v.gyro_leaps, 0);
      }
    }
  }
}
INSTANTIATE_TEST_SUITE_P(All, RealDrives, ::testing::ValuesIn(real_drive_names()),
                         [](const auto& of) { return of.param; });

}  // namespace
}  // namespace curbstone::ekf::filter
