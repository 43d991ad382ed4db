#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace curbstone::encoder {

/// Determines a drive's period from the arrivals of its first samples: a PeriodClock with a wrong period would stamp
/// them wrong by up to 0.3 s until it had measured.
///
/// The period is the nominal one if that explains kFew gaps in a row to half of it, which distinguishes a host that is
/// late by a few ms from a period that is off by 5 %. Another period is measured over kMany gaps. If all samples arrive
/// in bunches, it waits for kMaxSamples of them; then the period is the nominal one unless the mean differs by more
/// than 20 %. Pure; one thread. All times in us.
class FirstPeriod {
 public:
  static constexpr std::size_t kFew = 12;
  static constexpr std::size_t kMany = 64;
  static constexpr std::size_t kMaxSamples = 128;

  explicit FirstPeriod(std::int64_t nominal) : nominal_(nominal) {}

  /// Adds the arrival of the next sample. Returns the period once it is known.
  [[nodiscard]] std::optional<std::int64_t> add(std::int64_t received);
  /// Restarts after an interruption.
  void restart() { arrivals_.clear(); }

 private:
  [[nodiscard]] bool explains(std::int64_t period, std::size_t gaps) const;
  [[nodiscard]] std::optional<std::int64_t> mean_of_similar_gaps() const;
  [[nodiscard]] std::int64_t mean(std::size_t gaps) const;

  std::int64_t nominal_;
  std::vector<std::int64_t> arrivals_;
};

}  // namespace curbstone::encoder
