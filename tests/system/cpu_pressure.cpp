#include "tests/system/cpu_pressure.hpp"

#include <algorithm>
#include <cstdio>

#include "common/time/clock.hpp"
#include "tests/system/run_program.hpp"

namespace curbstone::system_test {
namespace {

/// us since the machine was started.
std::int64_t total_waited() {
  long long total = 0;
  const std::string text = read_file("/proc/pressure/cpu");
  return std::sscanf(text.c_str(), "some avg10=%*f avg60=%*f avg300=%*f total=%lld", &total) == 1 ? total : 0;
}

}  // namespace

CpuPressure::CpuPressure() : began_(steady_clock()), waited_(total_waited()) {}

double CpuPressure::share() const {
  const auto passed = static_cast<double>(steady_clock() - began_);
  return passed > 0 ? std::clamp(static_cast<double>(total_waited() - waited_) / passed, 0.0, 1.0) : 0.0;
}

}  // namespace curbstone::system_test
