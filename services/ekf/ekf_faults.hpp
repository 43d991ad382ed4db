#pragma once

#include <string>
#include <vector>

#include "common/config/vehicle.hpp"
#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/filter/filter.hpp"
#include "services/ekf/inputs/imu_outlier_filter.hpp"
#include "services/ekf/inputs/shaken_imu.hpp"
#include "services/ekf/inputs/stuck_accelerometer.hpp"
#include "services/ekf/mounting/mounting_watch.hpp"

/// Faults of IMU and wheels in an operator's words: each function appends the present faults, if any, to `faults`.
namespace curbstone::ekf {

void describe_wheels(const wheel_faults::WheelWatch& watch, std::vector<std::string>& faults);
void describe_axes(const filter::LostAxes& axes, std::vector<std::string>& faults);
/// Up to ten times the configured noise is not a fault: the filter takes it into account.
void describe_noise(const inputs::ShakenImu& imu, const base::NoiseConfig& configured,
                    std::vector<std::string>& faults);
void describe_leap(const filter::Filter& filter, std::vector<std::string>& faults);
void describe_vertical_force(const filter::VerticalForce& vertical, std::vector<std::string>& faults);
void describe_mounting(const mounting::MountingWatch& mounting, const VehicleConfig& vehicle,
                       std::vector<std::string>& faults);
void describe_imu_outliers(const inputs::ImuOutlierFilter& samples, std::vector<std::string>& faults);
void describe_accelerometer(const inputs::StuckAccelerometer& accelerometer, std::vector<std::string>& faults);

}  // namespace curbstone::ekf
