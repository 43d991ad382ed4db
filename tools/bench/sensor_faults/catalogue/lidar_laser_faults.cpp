#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"
#include "tools/bench/sensor_faults/catalogue/lidar_fault.hpp"
#include "tools/bench/sensor_faults/catalogue/points.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

using simulate::numerics::Random;

namespace {

using Beam = Eigen::Vector3d;

/// m, rad: a return as a laser measures it.
struct Shot {
  double range, azimuth, elevation;
};

/// change(shot) of the returns of one laser, or of all with laser < 0.
template <class ChangeOf>
auto shots(int laser, ChangeOf change_of) {
  return [=](double, lidar_points_t& m) {
    move_points(m, [&](Beam& p, std::size_t i) {
      const double range = p.norm();
      if (!(range > 0) || (laser >= 0 && m.ring[i] != laser)) return;
      Shot shot{range, std::atan2(p.y(), p.x()), std::asin(p.z() / range)};
      change_of(shot);
      const double reach = shot.range * std::cos(shot.elevation);
      p = {reach * std::cos(shot.azimuth), reach * std::sin(shot.azimuth), shot.range * std::sin(shot.elevation)};
    });
  };
}

/// Laser k of the RS16 looks 2 deg higher than laser k - 1, the lowest 15 deg down. `takes[k]`: the laser as which the
/// k-th is taken.
template <std::size_t N>
auto taken_as(const std::array<int, N>& takes) {
  return [takes](double, lidar_points_t& m) {
    move_points(m, [&](Beam& p, std::size_t i) {
      const auto other = static_cast<std::size_t>(m.ring[i]);
      if (other >= takes.size()) return;
      const double range = p.norm(), azimuth = std::atan2(p.y(), p.x());
      const double elevation = radians(2.0 * takes[other] - 15.0), reach = range * std::cos(elevation);
      p = {reach * std::cos(azimuth), reach * std::sin(azimuth), range * std::sin(elevation)};
    });
    for (auto& ring : m.ring)
      if (ring < takes.size()) ring = static_cast<std::uint8_t>(takes[ring]);
  };
}

constexpr std::array kSwapped = {0, 1, 2, 6, 4, 5, 3, 7, 8, 9, 10, 11, 12, 13, 14, 15};
constexpr std::array kNeighboursSwapped = {0, 1, 2, 3, 5, 4, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
constexpr std::array kByFiring = {0, 2, 4, 6, 8, 10, 12, 14, 1, 3, 5, 7, 9, 11, 13, 15};  // every other one

}  // namespace

std::vector<Fault> lidar_laser_faults() {
  return {
      lidar_fault("one laser dead", "laser 4 of 16 returns nothing", kOnTheWay,
                  [](double, auto& m) { keep_points(m, [&](const Beam&, std::size_t i) { return m.ring[i] != 4; }); }),
      lidar_fault("the lowest lasers dead", "lasers 0 to 3 of 16 return nothing: dirt along the window's lower edge",
                  kOnTheWay,
                  [](double, auto& m) { keep_points(m, [&](const Beam&, std::size_t i) { return m.ring[i] > 3; }); }),
      lidar_fault("one laser 15 cm long", "the ranges of laser 4 are 15 cm too long", kOnTheWay,
                  shots(4, [](Shot& shot) { shot.range += 0.15; })),
      lidar_fault("one laser 1 m long", "the ranges of laser 3 are 1 m too long", kOnTheWay,
                  shots(3, [](Shot& shot) { shot.range += 1.0; })),
      lidar_fault("one laser 0.6 deg low", "laser 4 looks 0.6 deg lower than the table says", kFromTheBeginning,
                  shots(4, [](Shot& shot) { shot.elevation += radians(0.6); })),
      lidar_fault("one laser 3 deg aside", "laser 4 looks 3 deg to the right of where the table has it",
                  kFromTheBeginning, shots(4, [](Shot& shot) { shot.azimuth += radians(3.0); })),
      lidar_fault("two lasers swapped", "lasers 3 and 6 are taken for each other", kFromTheBeginning,
                  taken_as(kSwapped)),
      lidar_fault("two neighbours swapped", "lasers 4 and 5 are taken for each other", kFromTheBeginning,
                  taken_as(kNeighboursSwapped)),
      lidar_fault("lasers in another order", "the table has the lasers in the order in which another device fires them",
                  kFromTheBeginning, taken_as(kByFiring)),
      lidar_fault("ranges in steps of 1 cm for 0.5 cm", "every range is twice as long: the unit is another firmware's",
                  kFromTheBeginning, shots(-1, [](Shot& shot) { shot.range *= 2.0; })),
      lidar_fault("azimuths damaged", "1 packet in 100 looks in another direction", kOnTheWay,
                  [random = Random(1)](double, auto& m) mutable {
                    const double by = radians(random.uniform(20, 340));
                    if (!random.chance(0.01)) return;
                    const double c = std::cos(by), s = std::sin(by);
                    move_points(m, [&](Beam& p, std::size_t) {
                      p = Beam(c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z());
                    });
                  }),
      lidar_fault("mirrored azimuth", "the head is believed to turn the other way: left is right", kFromTheBeginning,
                  [](double, auto& m) { move_points(m, [](Beam& p, std::size_t) { p.y() = -p.y(); }); }),
  };
}

}  // namespace curbstone::bench::sensor_faults::catalogue
