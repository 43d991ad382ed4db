#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"

#include <string>
#include <utility>

#include "tools/bench/sensor_faults/catalogue/points.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

namespace {

constexpr std::int32_t kAhead = 70'000;  // the other sender has sent so many messages more
constexpr std::int64_t kLater = 400;     // us after the first sender's message

Fault second_sender(std::string name, std::string words, Changes changes) {
  return {.sensor = "bus", .name = std::move(name), .words = std::move(words), .from = kOnTheWay, .make = [changes] {
            return changes;
          }};
}

}  // namespace

std::vector<Fault> second_sender_faults() {
  const auto lidar = change<lidar_points_t>([](double, auto& m) {
    m.packet += kAhead;
    m.utime += kLater;
    move_points(m, [](Eigen::Vector3d& p, std::size_t) { p = Eigen::Vector3d(-p.y(), p.x(), p.z()); });
  });
  const auto imu = change<imu_t>([](double, auto& m) {
    m.sequence += kAhead;
    m.utime += kLater;
    std::swap(m.acceleration[0], m.acceleration[1]);
    m.angular_rate[2] += 0.3;
  });
  const auto wheels = change<wheels_t>([](double, auto& m) {
    m.sequence += kAhead;
    m.utime += kLater;
    for (int wheel = 0; wheel < 2; ++wheel) m.angle[wheel] = 300.0 + 0.5 * m.angle[wheel];
  });
  return {
      second_sender("second LiDAR", "that looks to the left sends on the same channel", {.second_lidar = lidar}),
      second_sender("second IMU", "whose yaw rate is 0.3 rad/s more sends on the same channel", {.second_imu = imu}),
      second_sender("second encoder", "of wheels that turn half as fast sends on the same channel",
                    {.second_wheels = wheels}),
  };
}

}  // namespace curbstone::bench::sensor_faults::catalogue
