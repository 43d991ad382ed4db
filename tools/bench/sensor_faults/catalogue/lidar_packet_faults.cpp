#include <cstdint>
#include <deque>
#include <utility>

#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"
#include "tools/bench/sensor_faults/catalogue/lidar_fault.hpp"
#include "tools/simulate/numerics/random.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

using simulate::numerics::Random;

namespace {

constexpr std::int64_t kMillennium = 946'684'800'000'000;  // us: 1 January 2000

/// The messages of a sensor that is silent for `off` s and then stamps as if it had been switched on in 2000.
template <class Message>
Change<Message> started_again(double off) {
  return change<Message>([off, first = std::int64_t{0}](double t, Message& m) mutable {
    if (t < kOnTheWay + off) return false;
    if (first == 0) first = m.utime;
    m.utime += kMillennium - first;
    return true;
  });
}

/// What was sent a second ago.
auto a_second_ago() {
  return [sent = std::deque<lidar_points_t>()](double, lidar_points_t& m) mutable {
    constexpr std::size_t kSecond = 750;  // packets
    sent.push_back(m);
    if (sent.size() <= kSecond) return false;
    m = sent.front();
    sent.pop_front();
    return true;
  };
}

/// The paths are compared by the host's clock.
Fault in_tai() {
  constexpr std::int64_t kAhead = 37'000'000;  // us
  Fault fault = lidar_fault("LiDAR in TAI", "stamps are 37 s ahead", kFromTheBeginning,
                            [](double, auto& m) { m.utime += kAhead; });
  fault.clock_set_by = kAhead;
  return fault;
}

}  // namespace

std::vector<Fault> lidar_packet_faults() {
  return {
      lidar_fault("a third of the packets lost", "each third packet, by chance, is lost on the wire", kOnTheWay,
                  [random = Random(1), sent = std::int32_t{0}](double, auto& m) mutable {
                    if (random.chance(1.0 / 3)) return false;
                    m.packet = sent++;
                    return true;
                  }),
      {"LiDAR", "packets of a second ago", "each packet comes again a second later, as from a switch that loops",
       kOnTheWay, [] { return Changes{.second_lidar = change<lidar_points_t>(a_second_ago())}; }},
      {"LiDAR", "LiDAR starts again in 2000", "silent for 12 s, then its clock begins on 1 January 2000", kOnTheWay,
       [] { return Changes{.lidar = started_again<lidar_points_t>(12.0)}; }},
      lidar_fault("LiDAR a second late now and then", "PPS is lost and found: 1 s late for 3 s in each 12 s", kOnTheWay,
                  [](double t, auto& m) { m.utime += std::int64_t{static_cast<int>(t) % 12 < 3} * 1'000'000; }),
      in_tai(),
      {"LiDAR", "all silent for 5 s", "LiDAR, IMU and wheels send nothing for 5 s: a loose plug of the switch",
       kOnTheWay,
       [] {
         const auto off = [](double t, auto&) { return t > kOnTheWay + 5.0; };
         return Changes{change<lidar_points_t>(off), change<imu_t>(off), change<wheels_t>(off)};
       }},
      {"IMU", "IMU starts again in 2000", "silent for 5 s, then its clock begins on 1 January 2000", kOnTheWay,
       [] { return Changes{.imu = started_again<imu_t>(5.0)}; }},
      {"wheels", "encoder starts again in 2000", "silent for 5 s, then its clock begins on 1 January 2000", kOnTheWay,
       [] { return Changes{.wheels = started_again<wheels_t>(5.0)}; }},
  };
}

}  // namespace curbstone::bench::sensor_faults::catalogue
