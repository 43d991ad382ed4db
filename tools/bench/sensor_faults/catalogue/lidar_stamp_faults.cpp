#include <cmath>
#include <cstdint>
#include <utility>

#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"
#include "tools/bench/sensor_faults/catalogue/lidar_fault.hpp"
#include "tools/simulate/numerics/random.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

using simulate::numerics::Random;

namespace {

auto later(std::int64_t by) {
  return [by](double, lidar_points_t& m) { m.utime += by; };
}

/// The LiDAR's second is `part` longer than the host's, from `from` s on.
auto slow_clock(double part, double from) {
  return [=](double t, lidar_points_t& m) { m.utime += std::llround((t - from) * 1e6 * part); };
}

/// Nothing is sent in the first `gap` s of each `period` s.
auto gaps(double period, double gap) {
  return [=](double t, lidar_points_t&) { return std::fmod(t, period) >= gap; };
}

}  // namespace

std::vector<Fault> lidar_stamp_faults() {
  constexpr double kSetUp = kFromTheBeginning;
  return {
      lidar_fault("LiDAR stamps late", "stamps 60 ms after the laser fired", kSetUp, later(60'000)),
      lidar_fault("stamps of the revolution's end", "every stamp is a revolution, 50 ms, late", kSetUp, later(50'000)),
      lidar_fault("stamps of the revolution's start", "every stamp is a revolution, 50 ms, early", kSetUp,
                  later(-50'000)),
      lidar_fault("one stamp per revolution", "all packets of a revolution have the stamp of its first one", kSetUp,
                  [revolution = std::int32_t{-1}, first = std::int64_t{0}](double, auto& m) mutable {
                    if (std::exchange(revolution, m.revolution) != m.revolution) first = m.utime;
                    m.utime = first;
                  }),
      lidar_fault("stamps jitter", "3 ms of noise on every stamp", kOnTheWay,
                  [random = Random(1)](double, auto& m) mutable { m.utime += std::llround(random.normal(3000.0)); }),
      lidar_fault("LiDAR clock set back", "stamps jump back by 2 s, and go on from there", kOnTheWay,
                  later(-2'000'000)),
      lidar_fault("LiDAR clock half a second ahead", "stamps jump ahead by 0.5 s, and go on from there", kOnTheWay,
                  later(500'000)),
      lidar_fault("LiDAR clock set to and fro", "stamps jump back by 2 s, and 10 s later ahead by 2 s, and so on",
                  kOnTheWay, [](double t, auto& m) { m.utime -= std::fmod(t - kOnTheWay, 20.0) < 10 ? 2'000'000 : 0; }),
      lidar_fault("stamps damaged", "the stamp of 1 packet in 100 is up to 2 s early or late", kOnTheWay,
                  [random = Random(1)](double, auto& m) mutable {
                    const double by = random.uniform(-2e6, 2e6);
                    if (random.uniform(0, 1) < 0.01) m.utime += std::llround(by);
                  }),
      lidar_fault("LiDAR clock an hour ahead", "stamps jump ahead by an hour, and go on from there", kOnTheWay,
                  later(3'600'000'000)),
      lidar_fault("LiDAR clock 1 % slow", "its second is 1 % longer than the host's", kOnTheWay,
                  slow_clock(0.01, kOnTheWay)),
      lidar_fault("LiDAR clock 500 ppm slow", "its second is 0.05 % longer than the host's", kOnTheWay,
                  slow_clock(0.0005, kOnTheWay)),
      lidar_fault("revolutions misnumbered", "each twentieth revolution has the number of the one before", kOnTheWay,
                  [](double, auto& m) { m.revolution -= m.revolution % 20 == 0 ? 1 : 0; }),
      lidar_fault("LiDAR gaps of 0.6 s", "nothing for 0.6 s, every 5 s", kOnTheWay, gaps(5.0, 0.6)),
      lidar_fault("LiDAR gaps of 2 s", "nothing for 2 s, every 8 s", kOnTheWay, gaps(8.0, 2.0)),
      lidar_fault("LiDAR silent", "no more messages", kOnTheWay, [](double, auto&) { return false; }),
  };
}

}  // namespace curbstone::bench::sensor_faults::catalogue
