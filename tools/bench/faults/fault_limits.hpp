#pragma once

#include <string>
#include <vector>

#include "tools/bench/faults/fault_report.hpp"

namespace curbstone::bench::faults {

constexpr int kMaxSpreads = 2;     ///< cells a second that may differ: so many times what undisturbed drives differ by
constexpr double kBackWithin = 1;  ///< s

/// The limits that rows break, "row: what", in words; empty: none. A row keeps its limits if the cells are within
/// kMaxSpreads of the spread of as long a drive, no pose is missing, all is back within kBackWithin, the map file is
/// whole and all processes ended by themselves. Its excuse exempts it from the first three or from the time alone. Rows
/// that the machine spoiled break no limit: they are named by unjudged().
[[nodiscard]] std::vector<std::string> broken_limits(const FaultReport& report);
/// Rows that nothing can be said of, because the machine was busy.
[[nodiscard]] std::vector<std::string> unjudged(const FaultReport& report);

}  // namespace curbstone::bench::faults
