#include "tools/bench/sensor_faults/catalogue/points.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

using simulate::numerics::Random;

void put_in_sight(const Box& box, Random& random, lidar_points_t& message) {
  constexpr double kBlind = 0.3;   // m about the LiDAR, where it sees nothing
  constexpr double kNoise = 0.02;  // m
  move_points(message, [&](Eigen::Vector3d& point, std::size_t) {
    const double range = point.norm();
    if (!(range > 0)) return;
    const Eigen::Array3d to_low = box.low.array() / (point.array() / range);
    const Eigen::Array3d to_high = box.high.array() / (point.array() / range);
    const double enters = to_low.min(to_high).maxCoeff();
    const double leaves = to_low.max(to_high).minCoeff();
    if (enters > kBlind && enters <= leaves && enters < range) set_range(point, enters + random.normal(kNoise));
  });
}

}  // namespace curbstone::bench::sensor_faults::catalogue
