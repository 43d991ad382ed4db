#include <algorithm>
#include <cmath>

#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"
#include "tools/bench/sensor_faults/catalogue/lidar_fault.hpp"
#include "tools/bench/sensor_faults/catalogue/points.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

using simulate::numerics::Random;

namespace {

using Seen = Eigen::Vector3d;

constexpr double kRoad = -1.7;  // m: the ground, in the lidar frame

bool is_ground(const Seen& p) {
  return p.z() < kRoad + 0.3;
}

/// A part of what comes back beyond `near` m on the ground does not, and a part of what stands is seen below the ground
/// too, at the range of its mirror image.
void wet(lidar_points_t& m, double lost, double mirrored, Random& random) {
  move_points(m, [&](Seen& p, std::size_t) {
    if (!is_ground(p) || p.head<2>().norm() < 5.0 || !random.chance(mirrored)) return;
    p *= random.uniform(1.2, 2.5);  // on along the beam, below the ground
  });
  keep_points(m, [&](const Seen& p, std::size_t) {
    return !(is_ground(p) && p.z() > kRoad - 0.3 && p.head<2>().norm() > 5.0 && random.chance(lost));
  });
}

/// Drops within 6 m, fewer far returns, darker ones.
void rain(lidar_points_t& m, double drops, Random& random) {
  move_points(m, [&](Seen& p, std::size_t) {
    if (random.chance(drops)) set_range(p, std::min(p.norm(), 0.6 - 1.8 * std::log(1.0 - random.uniform())));
  });
  keep_points(m, [&](const Seen& p, std::size_t) { return random.chance(std::exp(-p.norm() / 30.0)); });
  for (auto& intensity : m.intensity) intensity = static_cast<std::uint8_t>(intensity / 2);
}

}  // namespace

std::vector<Fault> weather_faults() {
  return {
      lidar_fault("half of the window wet", "on the left half of the returns is lost and a tenth is at the window",
                  kOnTheWay,
                  [random = Random(1)](double, auto& m) mutable {
                    move_points(m, [&](Seen& p, std::size_t) {
                      if (p.y() > 0 && random.chance(0.1)) set_range(p, 0.3);
                    });
                    keep_points(m, [&](const Seen& p, std::size_t) { return p.y() < 0 || random.chance(0.5); });
                  }),
      lidar_fault("dirty sector", "on the right, from 60 to 120 deg, ranges beyond 4 m are up to 30 cm short",
                  kOnTheWay,
                  [random = Random(1)](double, auto& m) mutable {
                    move_points(m, [&](Seen& p, std::size_t) {
                      if (std::abs(azimuth_degrees(p) + 90.0) < 30.0 && p.norm() > 4.0)
                        set_range(p, p.norm() - random.uniform(0.0, 0.3));
                    });
                  }),
      lidar_fault("rain", "4 % of the returns are drops, and of what is 30 m away two thirds do not come back",
                  kOnTheWay, [random = Random(1)](double, auto& m) mutable { rain(m, 0.04, random); }),
      lidar_fault("wet road", "70 % of the ground beyond 5 m does not come back, and 10 % is seen below it", kOnTheWay,
                  [random = Random(1)](double, auto& m) mutable { wet(m, 0.7, 0.1, random); }),
      lidar_fault("mirror-like road", "all of the ground beyond 5 m shows what stands there, below the ground",
                  kOnTheWay, [random = Random(1)](double, auto& m) mutable { wet(m, 1.0, 0.5, random); }),
      {"LiDAR", "rain, a wet road and wheels that slip",
       "the rain and the wet road of above, and the left wheel turns "
       "60 % more for 0.5 s in each 2 s",
       kOnTheWay,
       [] {
         Changes changes;
         changes.lidar = change<lidar_points_t>([random = Random(1)](double, auto& m) mutable {
           rain(m, 0.04, random);
           wet(m, 0.7, 0.1, random);
         });
         changes.wheels = change<wheels_t>([slipped = 0.0](double t, auto& m) mutable {
           if (std::fmod(t, 2.0) < 0.5) slipped += 0.6 * m.speed[0] * 0.01;
           m.angle[0] += slipped;
         });
         return changes;
       }},
      lidar_fault("sun", "30 deg of the view are noise, where the sun stands low", kOnTheWay,
                  [random = Random(1)](double, auto& m) mutable {
                    move_points(m, [&](Seen& p, std::size_t) {
                      if (std::abs(azimuth_degrees(p) - 100.0) < 15.0) set_range(p, random.uniform(1.0, 80.0));
                    });
                  }),
      lidar_fault("carwash", "for 10 s brushes close in on both sides, and the spray is thick", kOnTheWay,
                  [random = Random(1)](double t, auto& m) mutable {
                    if (t > kOnTheWay + 10.0) return;
                    const double x = 2.0 * std::sin(0.8 * t);
                    put_in_sight({{x - 0.6, 1.0, -1.8}, {x + 0.6, 2.0, 1.0}}, random, m);
                    put_in_sight({{-x - 0.6, -2.0, -1.8}, {-x + 0.6, -1.0, 1.0}}, random, m);
                    move_points(m, [&](Seen& p, std::size_t) {
                      if (random.chance(0.3)) set_range(p, std::min(p.norm(), random.uniform(0.4, 4.0)));
                    });
                  }),
      lidar_fault("only the ground", "nothing but the ground comes back: an empty field, with curbs", kOnTheWay,
                  [](double, auto& m) { keep_points(m, [](const Seen& p, std::size_t) { return is_ground(p); }); }),
  };
}

}  // namespace curbstone::bench::sensor_faults::catalogue
