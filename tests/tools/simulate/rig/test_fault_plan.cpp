#include <gtest/gtest.h>

#include "tools/simulate/rig/fault_plan.hpp"

namespace curbstone::simulate::rig {
namespace {

TEST(FaultPlan, ReadsWhatIsWrongWithWhichSensorWhen) {
  const auto fault = rig::parse_fault("imu-garbage:10-12.5");
  ASSERT_TRUE(fault.has_value());
  rig::FaultPlan plan;
  plan.add(*fault);
  EXPECT_EQ(plan.at(rig::SensorFault::Sensor::kImu, 11), rig::SensorFault::Kind::kGarbage);
  EXPECT_EQ(plan.at(rig::SensorFault::Sensor::kImu, 12.5), std::nullopt);
  EXPECT_EQ(plan.at(rig::SensorFault::Sensor::kWheels, 11), std::nullopt);
}

TEST(FaultPlan, RefusesWhatIsNoFault) {
  for (const char* text :
       {"", "imu", "imu-silent", "imu-silent:", "imu-silent:5", "imu-silent:5-4", "imu-silent:5-6x", "radar-silent:1-2",
        "imu-loud:1-2", "imu-silent:-1-2", "imu-silent:nan-2", "lidar_silent:1-2"})
    EXPECT_FALSE(rig::parse_fault(text).has_value()) << text;
}

}  // namespace
}  // namespace curbstone::simulate::rig
