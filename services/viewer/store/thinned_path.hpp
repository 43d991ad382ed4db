#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace curbstone::viewer::store {

/// The driven path of the present epoch. Pure; one thread.
class ThinnedPath {
 public:
  static constexpr float kSpacing = 0.25F;            ///< m
  static constexpr std::size_t kMaxPoints = 200'000;  ///< 50 km; later points are dropped

  struct Point {
    std::int64_t utime = 0;     ///< us
    float x = 0, y = 0, z = 0;  ///< m in map
  };

  /// Takes a pose if it is `kSpacing` away from its neighbours in time. A pose between known points begins a new round.
  void put(const Point& point);
  /// Takes the pose that the vehicle has reached. It is the last one even if the host's clock was set back.
  void append(Point point);
  void clear();

  /// Ordered by time. Within a round, points are only appended.
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  [[nodiscard]] std::uint32_t round() const { return round_; }

 private:
  std::vector<Point> points_;
  std::uint32_t round_ = 1;
  std::int64_t newest_ = 0;  // us, of the last point appended
  std::int64_t behind_ = 0;  // us that the clock was set back since the path began
};

}  // namespace curbstone::viewer::store
