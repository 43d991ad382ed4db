#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

namespace curbstone::ekf::inputs {

/// When the samples of an IMU were taken, by stamps that a busy host made on receipt: late by some milliseconds each,
/// and now and then by a lot. An IMU samples evenly, and no stamp is early. So stamps lie on or above a straight line
/// over the samples' numbers, and that line is when they were taken: its slope is that of the lower convex hull of the
/// last kMemory points, its height that of the least late of the last kRecent. What all stamps are late by does not
/// show.
///
/// Stamps are changed only where they jitter (kJitter above the line, on average) and stay near the line for long. What
/// is sampled unevenly, or lost without a trace in the sequence numbers, strays from any line; that, regular stamps,
/// gaps and steps of the clock are left as they are, bit for bit. Stamps that come out are never later than those that
/// go in, and grow where those do.
///
/// A function of the channel's sequence alone. Pure; one thread; us.
class StampStraightener {
 public:
  static constexpr std::size_t kMemory = 512;  ///< samples
  static constexpr double kJitter = 2'000.0;   ///< us, mean lateness; below, stamps are taken for good

  /// The next sample's stamp and the device's sequence number, which tells how many samples were lost; a number that
  /// does not go on says nothing. Returns when it was taken.
  [[nodiscard]] std::int64_t add(std::int64_t stamp, std::int32_t sequence);
  /// Whether stamps are being changed.
  [[nodiscard]] bool active() const { return active_; }

 private:
  struct Point {
    std::int64_t number;  // of the sample, lost ones counted
    std::int64_t stamp;
  };
  void restart();
  void learn();
  [[nodiscard]] double slope() const;
  [[nodiscard]] double least_height(std::size_t samples) const;
  /// us, by which a point lies above the line through the first point, with the period's slope.
  [[nodiscard]] double height(const Point& point) const;
  [[nodiscard]] bool stays_near() const;

  std::deque<Point> points_;
  std::int32_t sequence_ = 0;
  std::int64_t last_stamp_ = 0;  // as it came
  std::int64_t last_out_ = 0;
  std::int64_t learnt_at_ = 0;  // number
  int astray_ = 0;              // stamps in a row that are far from those before
  double period_ = 0.0;         // us; 0: not known yet
  bool active_ = false;
};

}  // namespace curbstone::ekf::inputs
