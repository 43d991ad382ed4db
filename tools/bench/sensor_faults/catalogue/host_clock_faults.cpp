#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"

#include <cstdint>
#include <string>
#include <utility>

namespace curbstone::bench::sensor_faults::catalogue {

namespace {

constexpr std::int64_t kSecond = 1'000'000;  // us
constexpr std::int64_t kHour = 3600 * kSecond;
constexpr std::int64_t kYear = 365 * 24 * kHour;

Fault set_by(std::string name, std::string words, std::int64_t by) {
  const auto later = [by](double, auto& m) { m.utime += by; };
  return {.sensor = "host clock",
          .name = std::move(name),
          .words = std::move(words),
          .from = kOnTheWay,
          .make =
              [later] {
                return Changes{change<lidar_points_t>(later), change<imu_t>(later), change<wheels_t>(later)};
              },
          .clock_set_by = by};
}

}  // namespace

std::vector<Fault> host_clock_faults() {
  return {
      set_by("host clock set back 2 s", "all stamps jump back by 2 s, and go on from there", -2 * kSecond),
      set_by("host clock set 2 s ahead", "all stamps jump ahead by 2 s, and go on from there", 2 * kSecond),
      set_by("host clock set back an hour", "all stamps jump back by an hour: a wrong time zone, put right", -kHour),
      set_by("host clock set 8 years ahead", "all stamps jump ahead by 8 years: a PC without a battery hears NTP",
             8 * kYear),
  };
}

}  // namespace curbstone::bench::sensor_faults::catalogue
