#include "tools/log_tool/log_time.hpp"

#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <stdexcept>

namespace curbstone::log_tool {

namespace {

constexpr std::int64_t kEndOfYears = 253'402'300'800'000'000;  // us: the year 10000

/// The whole text as a number; empty if it is not one.
std::optional<double> number_in(const std::string& text) {
  std::size_t used = 0;
  try {
    const double number = std::stod(text, &used);
    if (used == text.size() && std::abs(number) < 1e12) return number;
  } catch (const std::exception&) {
    return std::nullopt;
  }
  return std::nullopt;
}

std::int64_t to_us(double seconds) {
  return std::llround(seconds * 1e6);
}

}  // namespace

LogTime::LogTime(const std::string& text, const std::string& option) {
  if (const auto seconds = number_in(text)) {
    us_ = to_us(*seconds);
    return;
  }
  relative_ = false;
  std::tm utc{};
  const char* rest = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &utc);
  std::string fraction = rest == nullptr ? "?" : rest;
  if (!fraction.empty() && fraction.back() == 'Z') fraction.pop_back();
  const auto part = fraction.empty()     ? std::optional(0.0)
                    : fraction[0] == '.' ? number_in("0" + fraction)
                                         : std::nullopt;
  if (!part)
    throw std::runtime_error(
        fmt::format("{} {}: expected seconds from the beginning (12.5) or UTC (2026-11-23T20:52:00Z)", option, text));
  us_ = std::int64_t{timegm(&utc)} * 1'000'000 + to_us(*part);
}

std::string utc_text(std::int64_t utime) {
  if (utime < 0 || utime >= kEndOfYears) return fmt::format("{} us", utime);
  const std::time_t seconds = utime / 1'000'000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  (void)std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  return fmt::format("{}.{:03}Z", text, utime / 1000 % 1000);
}

}  // namespace curbstone::log_tool
