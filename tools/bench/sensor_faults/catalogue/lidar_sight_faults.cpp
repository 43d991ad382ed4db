#include <algorithm>
#include <cmath>

#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"
#include "tools/bench/sensor_faults/catalogue/lidar_fault.hpp"
#include "tools/bench/sensor_faults/catalogue/points.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

using simulate::numerics::Random;

namespace {

using Point = Eigen::Vector3d;

/// Only the points for which is_seen(point) holds.
template <class IsSeen>
auto only(IsSeen is_seen) {
  return
      [is_seen](double, lidar_points_t& m) { keep_points(m, [&](const Point& p, std::size_t) { return is_seen(p); }); };
}

/// `part` of the points, drawn by chance, are at most range(random) m away.
template <class Range>
void put_in_the_way(lidar_points_t& m, double part, Random& random, Range range) {
  move_points(m, [&](Point& p, std::size_t) {
    if (random.chance(part)) set_range(p, std::min(p.norm(), range(random)));
  });
}

}  // namespace

std::vector<Fault> lidar_sight_faults() {
  return {
      lidar_fault("half of the points", "every other point, by chance, is missing", kOnTheWay,
                  [random = Random(1)](double, auto& m) mutable {
                    keep_points(m, [&](const Point&, std::size_t) { return random.chance(0.5); });
                  }),
      lidar_fault("nothing beyond 8 m", "a dirty window or a wet road: no point beyond 8 m", kOnTheWay,
                  only([](const Point& p) { return p.norm() < 8.0; })),
      lidar_fault("nothing ahead", "no points within 60 deg of ahead", kOnTheWay,
                  only([](const Point& p) { return std::abs(azimuth_degrees(p)) > 60.0; })),
      lidar_fault("nothing behind", "no points within 90 deg of behind", kOnTheWay,
                  only([](const Point& p) { return std::abs(azimuth_degrees(p)) < 90.0; })),
      lidar_fault("drop on the window", "20 deg of the view are at 0.5 m", kOnTheWay,
                  [](double, auto& m) {
                    move_points(m, [](Point& p, std::size_t) {
                      if (std::abs(azimuth_degrees(p) - 30.0) < 10.0) set_range(p, 0.5);
                    });
                  }),
      lidar_fault("fog", "30 % of the points are in the fog, and none is beyond 18 m", kOnTheWay,
                  [random = Random(1)](double, auto& m) mutable {
                    put_in_the_way(m, 0.3, random, [](Random& r) { return 1.0 - 3.0 * std::log(1.0 - r.uniform()); });
                    keep_points(m, [](const Point& p, std::size_t) { return p.norm() < 18.0; });
                  }),
      lidar_fault("snow", "8 % of the points are flakes, up to 12 m away", kOnTheWay,
                  [random = Random(1)](double, auto& m) mutable {
                    put_in_the_way(m, 0.08, random, [](Random& r) { return r.uniform(0.5, 12.0); });
                  }),
      lidar_fault("mirror on the right", "60 % of what is more than 4 m to the right is seen twice as far behind it",
                  kOnTheWay,
                  [random = Random(1)](double, auto& m) mutable {
                    move_points(m, [&](Point& p, std::size_t) {
                      if (p.y() < -4.0 && random.chance(0.6)) p.y() += 2.0 * (p.y() + 4.0);
                    });
                  }),
  };
}

}  // namespace curbstone::bench::sensor_faults::catalogue
