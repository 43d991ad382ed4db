#include "drivers/lidar/models/robosense/packet_time.hpp"

#include <chrono>

namespace curbstone::lidar::models::robosense {

using std::chrono::microseconds;
using std::chrono::sys_days;

std::optional<std::int64_t> utime_from(const PacketTime& time) {
  const std::chrono::year_month_day date{std::chrono::year{2000 + time.year}, std::chrono::month{time.month},
                                         std::chrono::day{time.day}};
  if (!date.ok() || time.hour > 23 || time.minute > 59 || time.second > 59 || time.millisecond > 999 ||
      time.microsecond > 999)
    return std::nullopt;
  const auto utc = sys_days{date} + std::chrono::hours{time.hour} + std::chrono::minutes{time.minute} +
                   std::chrono::seconds{time.second} + std::chrono::milliseconds{time.millisecond} +
                   microseconds{time.microsecond};
  return microseconds{utc.time_since_epoch()}.count();
}

PacketTime packet_time_from(std::int64_t utime) {
  const std::chrono::sys_time<microseconds> utc{microseconds{utime}};
  const sys_days day = std::chrono::floor<std::chrono::days>(utc);
  const std::chrono::year_month_day date{day};
  const std::chrono::hh_mm_ss clock{utc - day};
  const auto fraction = clock.subseconds().count();
  PacketTime time;
  time.year = static_cast<std::uint8_t>(static_cast<int>(date.year()) - 2000);
  time.month = static_cast<std::uint8_t>(static_cast<unsigned>(date.month()));
  time.day = static_cast<std::uint8_t>(static_cast<unsigned>(date.day()));
  time.hour = static_cast<std::uint8_t>(clock.hours().count());
  time.minute = static_cast<std::uint8_t>(clock.minutes().count());
  time.second = static_cast<std::uint8_t>(clock.seconds().count());
  time.millisecond = static_cast<std::uint16_t>(fraction / 1000);
  time.microsecond = static_cast<std::uint16_t>(fraction % 1000);
  return time;
}

}  // namespace curbstone::lidar::models::robosense
