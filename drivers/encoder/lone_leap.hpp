#pragma once

#include <array>
#include <optional>

namespace curbstone::encoder {

/// Detects a sample that leaps away from those before it and that the next one does not confirm: a damaged digit on a
/// line without a checksum, or a sample of another time. No wheel turns forth and back within a period. What a sample
/// leaps is its error against what the samples before it predict. Pure; one thread.
///
/// A sample is refused if it leaps by more than the tolerance, and by more than kTimes what this wheel usually does; so
/// a drive that samples unevenly, or shakes, is not refused. If the next one has leapt at least half as far the same
/// way, the wheel did turn so, and that one is good: a refused one that was true costs itself, and its distance is in
/// the next one. After kMost refused in a row the next is good anyway.
class LoneLeap {
 public:
  using Pair = std::array<double, 2>;
  static constexpr double kTimes = 8;
  static constexpr int kMost = 3;

  /// `error`: of both wheels, in the unit of `tolerance`. Returns whether the sample is refused.
  bool refuses(const Pair& error, double tolerance);
  void restart() { *this = {}; }

 private:
  Pair usual_{};              // mean absolute error
  std::optional<Pair> leap_;  // error of the latest sample, if that was refused
  int refused_ = 0;           // in a row
};

}  // namespace curbstone::encoder
