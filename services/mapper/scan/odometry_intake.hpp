#pragma once

#include <curbstone/odometry_t.hpp>
#include <optional>

#include "common/bus/counters.hpp"
#include "services/mapper/scan/odometry_history.hpp"

namespace curbstone::mapper::scan {

/// Nothing where the message is no pose at a time.
[[nodiscard]] std::optional<OdometrySample> sample_of(const odometry_t& message);

/// Adds what ODOMETRY says to the history. False, and counted as refused.odometry, where it is no pose at a time. Late
/// samples and clocks that jump are counted too: dropped.odometry_late, odometry.clock_jumps.
bool take_odometry(const odometry_t& message, OdometryHistory& history, Counters& counters);

}  // namespace curbstone::mapper::scan
