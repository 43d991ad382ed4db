#include "tools/simulate/devices/gprmc.hpp"

#include <array>
#include <chrono>
#include <cstdio>

namespace curbstone::simulate::devices {

std::string gprmc(std::int64_t utime) {
  using std::chrono::floor;
  const std::chrono::sys_time<std::chrono::microseconds> now{std::chrono::microseconds{utime}};
  const auto day = floor<std::chrono::days>(now);
  const std::chrono::year_month_day date{day};
  const std::chrono::hh_mm_ss time{floor<std::chrono::seconds>(now - day)};
  std::array<char, 96> body{};
  std::snprintf(body.data(), body.size(), "GPRMC,%02d%02d%02d,A,5231.2000,N,01324.3000,E,000.0,000.0,%02u%02u%02d,,,A",
                static_cast<int>(time.hours().count()), static_cast<int>(time.minutes().count()),
                static_cast<int>(time.seconds().count()), static_cast<unsigned>(date.day()),
                static_cast<unsigned>(date.month()), static_cast<int>(date.year()) % 100);
  const std::string text = body.data();
  unsigned sum = 0;
  for (const char c : text) sum ^= static_cast<unsigned char>(c);
  std::array<char, 8> tail{};
  std::snprintf(tail.data(), tail.size(), "*%02X\r\n", sum);
  return "$" + text + tail.data();
}

}  // namespace curbstone::simulate::devices
