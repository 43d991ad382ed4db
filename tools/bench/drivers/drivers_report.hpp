#pragma once

#include <string>
#include <vector>

#include "tools/bench/drivers/driver_rates.hpp"

namespace curbstone::bench::drivers {

struct DriversReport {
  std::vector<LidarRate> lidars;
  std::vector<StreamRate> streams;
};

void print_report(const DriversReport& report);
/// Writes JSON. Throws std::runtime_error if the file cannot be written.
void write_report(const DriversReport& report, const std::string& file);

}  // namespace curbstone::bench::drivers
