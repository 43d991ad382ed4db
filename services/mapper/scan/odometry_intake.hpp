#pragma once

#include <curbstone/odometry_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/scan/odometry_history.hpp"

namespace curbstone::mapper::scan {

/// Converts the message; nothing if it is not a valid pose at a valid time.
[[nodiscard]] std::optional<OdometrySample> sample_of(const odometry_t& message);

/// Adds an ODOMETRY message to the history. Returns false and counts refused.odometry if it is not a valid pose at a
/// valid time. Also counts late samples, clock jumps and samples of another filter: dropped.odometry_late,
/// odometry.clock_jumps, refused.second_odometry.
bool take_odometry(const odometry_t& message, OdometryHistory& history, Counters& counters);

/// The fault of a bus on which two filters publish ODOMETRY.
void add_second_filter_fault(const OdometryHistory& history, std::vector<std::string>& faults);

}  // namespace curbstone::mapper::scan
