#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"
#include "tools/bench/sensor_faults/catalogue/lidar_fault.hpp"
#include "tools/bench/sensor_faults/catalogue/points.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

using simulate::numerics::Random;

namespace {

/// Every range becomes of(range, point), m.
template <class Of>
auto ranges(Of of) {
  return [of](double, lidar_points_t& m) {
    move_points(m, [&](Eigen::Vector3d& p, std::size_t) { set_range(p, of(p.norm(), p)); });
  };
}

/// `part` of the points, drawn by chance, become what spoil(point, random) makes of them.
template <class Spoil>
auto spoiled(double part, Spoil spoil) {
  return [part, spoil, random = Random(1)](double, lidar_points_t& m) mutable {
    move_points(m, [&](Eigen::Vector3d& p, std::size_t) {
      if (random.chance(part)) spoil(p, random);
    });
  };
}

}  // namespace

std::vector<Fault> lidar_return_faults() {
  using Point = Eigen::Vector3d;
  return {
      lidar_fault("ranges 10 cm long", "every range is 10 cm too long", kOnTheWay,
                  ranges([](double range, const Point&) { return range + 0.10; })),
      lidar_fault("ranges 8 cm short", "every range is 8 cm too short", kOnTheWay,
                  ranges([](double range, const Point&) { return range - 0.08; })),
      lidar_fault("ranges 3 % long", "every range is 3 % too long", kFromTheBeginning,
                  ranges([](double range, const Point&) { return 1.03 * range; })),
      lidar_fault("ranges in steps of 20 cm", "ranges are rounded", kOnTheWay,
                  ranges([](double range, const Point&) { return std::round(range / 0.2) * 0.2; })),
      lidar_fault(
          "ranges off by direction", "6 cm too long on the left, 6 cm too short on the right", kOnTheWay,
          ranges([](double range, const Point& p) { return range + 0.06 * std::sin(std::atan2(p.y(), p.x())); })),
      lidar_fault("elevations 8 % too large", "the table of the lasers is another device's", kFromTheBeginning,
                  [](double, auto& m) {
                    move_points(m, [](Point& p, std::size_t) {
                      const double range = p.norm(), azimuth = std::atan2(p.y(), p.x());
                      const double elevation = 1.08 * std::asin(range > 0 ? p.z() / range : 0.0);
                      const double reach = range * std::cos(elevation);
                      p = Point(reach * std::cos(azimuth), reach * std::sin(azimuth), range * std::sin(elevation));
                    });
                  }),
      lidar_fault("rings counted from above", "ring 0 is the highest beam", kFromTheBeginning,
                  [](double, auto& m) {
                    for (auto& ring : m.ring) ring = static_cast<std::uint8_t>(15 - ring);
                  }),
      lidar_fault(
          "three lasers of four dead", "rings 0, 4, 8, 12 only", kOnTheWay,
          [](double, auto& m) { keep_points(m, [&](const Point&, std::size_t i) { return m.ring[i] % 4 == 0; }); }),
      lidar_fault("intensities 0", "every intensity is 0", kOnTheWay,
                  [](double, auto& m) { std::ranges::fill(m.intensity, std::uint8_t{0}); }),
      lidar_fault("intensities 255", "every intensity is 255", kOnTheWay,
                  [](double, auto& m) { std::ranges::fill(m.intensity, std::uint8_t{255}); }),
      lidar_fault("crosstalk", "3 % of the points at random shorter ranges", kOnTheWay,
                  spoiled(0.03, [](Point& p, Random& random) { p *= random.uniform(0.2, 1.0); })),
      lidar_fault("points NaN", "1 % of the points are NaN", kOnTheWay,
                  spoiled(0.01, [](Point& p, Random&) { p.setConstant(std::numeric_limits<double>::quiet_NaN()); })),
      lidar_fault("points at 0", "5 % of the points are at the LiDAR itself", kOnTheWay,
                  spoiled(0.05, [](Point& p, Random&) { p.setZero(); })),
      lidar_fault("points far off", "2 % of the points are 50 times too far", kOnTheWay,
                  spoiled(0.02, [](Point& p, Random&) { p *= 50.0; })),
  };
}

}  // namespace curbstone::bench::sensor_faults::catalogue
