#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace curbstone::viewer::store {

/// Where the vehicle drove, in the present epoch. Pure; one thread.
class ThinnedPath {
 public:
  static constexpr float kSpacing = 0.25F;            ///< m
  static constexpr std::size_t kMaxPoints = 200'000;  ///< 50 km; what comes after is left out

  struct Point {
    std::int64_t utime = 0;     ///< us
    float x = 0, y = 0, z = 0;  ///< m in map
  };

  /// Takes a pose that is `kSpacing` away from its neighbours in time. One between known points begins a new round.
  void put(const Point& point);
  void clear();

  /// In order of time. Within a round the list only grows at its end.
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  [[nodiscard]] std::uint32_t round() const { return round_; }

 private:
  std::vector<Point> points_;
  std::uint32_t round_ = 1;
};

}  // namespace curbstone::viewer::store
