#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

namespace curbstone::ekf::inputs {

/// Estimates when the samples of an IMU were taken, from stamps that a busy host made on receipt: each is late by some
/// milliseconds, some by a lot. An IMU samples evenly, and no stamp is early. So the stamps lie on or above a straight
/// line over the sample numbers, and that line gives the sampling times: its slope is that of the lower convex hull of
/// the last kMemory points, its height that of the least late of the last kRecent. A delay that all stamps share cannot
/// be seen.
///
/// Stamps are changed only where they jitter (kJitter above the line, on average) and stay near the line for long.
/// Uneven sampling, and losses that the sequence numbers do not show, stray from any line; these, regular stamps, gaps
/// and steps of the clock are left as they are, bit for bit. Output stamps are never later than input stamps, and
/// increase where those do.
///
/// A function of the channel's sequence alone. Pure; one thread; us.
class StampSmoother {
 public:
  static constexpr std::size_t kMemory = 512;  ///< samples
  static constexpr double kJitter = 2'000.0;   ///< us, mean lateness below which stamps are left as they are

  /// Takes the next sample's stamp and the device's sequence number, which shows how many samples were lost; a number
  /// that does not continue is ignored. Returns the time of sampling.
  [[nodiscard]] std::int64_t add(std::int64_t stamp, std::int32_t sequence);

 private:
  struct Point {
    std::int64_t number;  // of the sample, including lost ones
    std::int64_t stamp;
  };
  void restart();
  void learn();
  [[nodiscard]] double slope() const;
  [[nodiscard]] double min_height(std::size_t samples) const;
  /// us, height of a point above the line through the first point with the period as slope.
  [[nodiscard]] double height(const Point& point) const;
  [[nodiscard]] bool stays_near() const;

  std::deque<Point> points_;
  std::int32_t sequence_ = 0;
  std::int64_t last_stamp_ = 0;  // as received
  std::int64_t last_out_ = 0;
  std::int64_t learnt_at_ = 0;  // sample number
  int outliers_ = 0;            // consecutive stamps far from those before
  double period_ = 0.0;         // us; 0: not known yet
  bool active_ = false;         // stamps are being changed
};

}  // namespace curbstone::ekf::inputs
