#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"

#include <cmath>

#include "tools/bench/sensor_faults/catalogue/points.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

using simulate::numerics::Random;

namespace {

/// `where`: the boxes at t, s.
template <class Where>
Fault things(std::string name, std::string words, double from, Where where) {
  return {"surroundings", std::move(name), std::move(words), from, [where] {
            return Changes{.lidar = change<lidar_points_t>([where, random = Random(1)](double t, auto& m) mutable {
                             for (const Box& box : where(t)) put_in_sight(box, random, m);
                           })};
          }};
}

using Boxes = std::vector<Box>;

Box person(double x, double y) {
  return {{x - 0.25, y - 0.25, -1.7}, {x + 0.25, y + 0.25, 0.1}};
}

/// What the vehicle stands on turns at `rate`, rad/s, until `end`, s: LiDAR and gyro see it, the wheels do not. The
/// vehicle looks ahead at the end, as the truth has it.
Fault turning_ground(std::string name, std::string words, double rate, double end) {
  return {"surroundings", std::move(name), std::move(words), kFromTheBeginning, [rate, end] {
            Changes changes;
            changes.imu = change<imu_t>([rate, end](double t, auto& m) { m.angular_rate[2] += t < end ? rate : 0.0; });
            changes.lidar = change<lidar_points_t>([rate, end](double t, lidar_points_t& m) {
              if (t >= end) return;
              const double angle = rate * (t - end), c = std::cos(angle), s = std::sin(angle);
              move_points(m, [&](Eigen::Vector3d& p, std::size_t) {
                p = Eigen::Vector3d(c * p.x() + s * p.y(), c * p.y() - s * p.x(), p.z());
              });
            });
            return changes;
          }};
}

std::vector<Fault> people_and_lorries() {
  return {
      things("crowd", "twelve people walk round the vehicle, 2 to 6 m away", kOnTheWay,
             [](double t) {
               Boxes people;
               for (int i = 0; i < 12; ++i) {
                 const double away = 2.0 + 0.35 * i, angle = (i % 2 == 0 ? 1 : -1) * 1.2 / away * t + 0.52 * i;
                 people.push_back(person(away * std::cos(angle), away * std::sin(angle)));
               }
               return people;
             }),
      things("traffic at the start", "lorries roll by on either side while the vehicle stands and sets off",
             kFromTheBeginning,
             [](double t) {
               if (t > 12.0) return Boxes{};
               const double x = -12 + 1.5 * t;
               return Boxes{{{x - 8, 2.0, -1.8}, {x + 8, 4.5, 2.0}}, {{-x - 8, -4.5, -1.8}, {-x + 8, -2.0, 2.0}}};
             }),
      things("lorries at the start", "a lorry on either side stands, and sets off with the vehicle", kFromTheBeginning,
             [](double t) {
               if (t > 20.0) return Boxes{};
               return Boxes{{{-8.0, 2.0, -1.8}, {8.0, 4.5, 2.0}}, {{-8.0, -4.5, -1.8}, {8.0, -2.0, 2.0}}};
             }),
      things("load on the roof", "a ladder over the LiDAR, from the front to the rear", kFromTheBeginning,
             [](double) {
               return Boxes{{{-2.0, -0.6, 0.35}, {2.0, 0.6, 0.45}}};
             }),
      turning_ground("turntable", "what it stands on turns at 3 deg/s, to 0.5 s before it sets off", 0.052, 3.5),
  };
}

}  // namespace

std::vector<Fault> surroundings_faults() {
  std::vector<Fault> faults = {
      things("trailer", "a trailer behind the vehicle, 3.5 m long, that turns with it", kOnTheWay,
             [](double) {
               return Boxes{{{-5.5, -0.9, -1.5}, {-2.0, 0.9, 0.4}}};
             }),
      things("rider", "somebody stands on the back of the vehicle", kOnTheWay,
             [](double) {
               return Boxes{{{-1.9, -0.3, -1.2}, {-1.55, 0.3, 0.5}}};
             }),
      things("follower", "a car follows at 7 to 11 m", kOnTheWay,
             [](double t) {
               const double x = -9 + 1.5 * std::sin(t / 3);
               return Boxes{{{x - 4, -0.9, -1.5}, {x, 0.9, 0.0}}};
             }),
      things("leader", "a car drives ahead at 6 to 10 m", kOnTheWay,
             [](double t) {
               const double x = 8 + 2 * std::sin(t / 4);
               return Boxes{{{x, -0.9, -1.5}, {x + 4, 0.9, 0.0}}};
             }),
      things("walker", "a pedestrian walks round the vehicle, 4 m away", kOnTheWay,
             [](double t) {
               const Eigen::Vector3d centre(4 * std::cos(1.2 * t), 4 * std::sin(1.2 * t), -0.8);
               const Eigen::Vector3d half(0.25, 0.25, 0.9);
               return Boxes{{centre - half, centre + half}};
             }),
      things("bus beside", "a bus close on the left at the same speed", kOnTheWay,
             [](double) {
               return Boxes{{{-6.0, 2.0, -1.8}, {6.0, 4.5, 1.3}}};
             }),
      things("bus that drifts", "a bus on the left at about the same speed: 3 m forth and back, 0.4 m to and fro",
             kOnTheWay,
             [](double t) {
               const double x = 3 * std::sin(t / 5), y = 0.4 * std::sin(t / 3);
               return Boxes{{{x - 6.0, 2.2 + y, -1.8}, {x + 6.0, 4.7 + y, 1.3}}};
             }),
      things("column", "cars ahead, behind and on either side, all at about the same speed", kOnTheWay,
             [](double t) {
               const double x = 0.7 * std::sin(t / 4), y = 0.3 * std::sin(t / 3);
               return Boxes{{{6.0 + x, -0.9, -1.5}, {10.0 + x, 0.9, 0.0}},
                            {{-11.0 + x, -0.9, -1.5}, {-7.0 + x, 0.9, 0.0}},
                            {{-1.5 - x, 2.2 + y, -1.5}, {2.8 - x, 4.0 + y, 0.0}},
                            {{-3.5 + x, -4.0 + y, -1.5}, {0.8 + x, -2.2 + y, 0.0}}};
             }),
      things("between lorries", "a lorry on either side, 2 m away, both at the same speed", kOnTheWay,
             [](double) {
               return Boxes{{{-8.0, 2.0, -1.8}, {8.0, 4.5, 2.0}}, {{-8.0, -4.5, -1.8}, {8.0, -2.0, 2.0}}};
             }),
      things("overtaken", "lorries overtake on the left at 3 m/s more, one every 10 s", kOnTheWay,
             [](double t) {
               const double x = -15 + 3 * std::fmod(t, 10.0);
               return Boxes{{{x - 5, 2.0, -1.8}, {x + 5, 4.5, 1.8}}};
             }),
      things("oncoming", "lorries come the other way, one every 6 s", kOnTheWay,
             [](double t) {
               const double x = 25 - 7 * std::fmod(t, 6.0);
               return Boxes{{{x - 5, 2.0, -1.8}, {x + 5, 4.5, 1.8}}};
             }),
  };
  for (Fault& fault : people_and_lorries()) faults.push_back(std::move(fault));
  return faults;
}

}  // namespace curbstone::bench::sensor_faults::catalogue
