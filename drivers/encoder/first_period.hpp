#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace curbstone::encoder {

/// Which period a drive keeps, by the arrivals of its first samples: a PeriodClock that took another period for granted
/// would stamp them wrong by up to 0.3 s, until it had measured.
///
/// It is the nominal one if that explains kFew gaps in a row to half of it, so that a host that is late by a few ms and
/// a period that is off by 5 % are distinguished. Another one is measured over kMany gaps. If all come in bunches,
/// kMost samples are awaited; then the nominal one is believed unless the mean is off by more than 20 %. Pure; one
/// thread. All times in us.
class FirstPeriod {
 public:
  static constexpr std::size_t kFew = 12;
  static constexpr std::size_t kMany = 64;
  static constexpr std::size_t kMost = 128;  ///< samples

  explicit FirstPeriod(std::int64_t nominal) : nominal_(nominal) {}

  /// The next sample arrives. Says the period once it is known.
  [[nodiscard]] std::optional<std::int64_t> add(std::int64_t received);
  /// The samples were interrupted: from the beginning.
  void restart() { arrivals_.clear(); }

 private:
  [[nodiscard]] bool explains(std::int64_t period, std::size_t gaps) const;
  [[nodiscard]] std::optional<std::int64_t> of_like_gaps() const;
  [[nodiscard]] std::int64_t mean(std::size_t gaps) const;

  std::int64_t nominal_;
  std::vector<std::int64_t> arrivals_;
};

}  // namespace curbstone::encoder
