#include <gtest/gtest.h>

#include <cmath>

#include "tests/tools/simulate/drives.hpp"
#include "tools/simulate/sensors/wheel_model.hpp"

namespace curbstone::simulate::sensors {
namespace {

sensors::WheelNoise perfect() {
  sensors::WheelNoise noise;
  noise.radius_error = 0;
  noise.slips_per_minute = 0;
  return noise;
}

TEST(WheelModel, CountsIntegrateToTheDistanceAndTheTurn) {
  const VehicleConfig vehicle;
  sensors::WheelModel wheels(perfect(), vehicle, test_motion(), 40, numerics::Random(1));
  const auto counts = wheels.counts(28.0);
  const double per_count = 2 * M_PI * vehicle.wheel_radius / 4096;
  const double left = per_count * static_cast<double>(counts[0]), right = per_count * static_cast<double>(counts[1]);
  EXPECT_NEAR(0.5 * (left + right), test_motion().profile().distance(28.0), 0.05);
  const auto yaw = [&](double t) { return roll_pitch_yaw(test_motion().T_world_base(t).linear()).z(); };
  EXPECT_NEAR((right - left) / vehicle.track_width, std::remainder(yaw(28) - yaw(0), 2 * M_PI), 0.01);
}

TEST(WheelModel, StandsStillWhenTheVehicleDoes) {
  sensors::WheelModel wheels({}, {}, test_motion(), 40, numerics::Random(1));
  EXPECT_EQ(wheels.counts(3.9), (std::array<std::int64_t, 2>{0, 0}));
}

TEST(WheelModel, IsOffByNoMoreThanItsErrors) {
  sensors::WheelModel wheels({}, {}, test_motion(), 40, numerics::Random(9)),
      ideal(perfect(), {}, test_motion(), 40, numerics::Random(9));
  const auto counts = wheels.counts(30), truth = ideal.counts(30);
  for (std::size_t i = 0; i < 2; ++i) {
    const double ratio = static_cast<double>(counts[i]) / static_cast<double>(truth[i]);
    EXPECT_NEAR(ratio, 1.0, 0.012);
    EXPECT_NE(counts[i], truth[i]);
  }
}

}  // namespace
}  // namespace curbstone::simulate::sensors
