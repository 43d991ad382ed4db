#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "services/mapper/mapper.hpp"
#include "services/mapper/revolution_assembler.hpp"
#include "tests/services/mapper/synthetic_world.hpp"

namespace curbstone::test {

inline constexpr double kPeriod = 0.05;  // s

inline std::int64_t utime(double seconds) {
  return SyntheticWorld::kEpoch + std::llround(seconds * 1e6);
}

/// A vehicle at 3 m/s on a gentle curve.
inline Pose driving(double t) {
  return pose(-10, 0, 0, 0, 0, 0) * move({{3, 0, 0}, {0, 0, 0.05}}, t);
}

inline Revolution revolution_of(const std::vector<lidar_points_t>& packets) {
  RevolutionAssembler assembler;
  for (const lidar_points_t& packet : packets) (void)assembler.add(packet);
  return *assembler.flush();
}

/// A mapper on a synthetic drive; poses are compared with the truth relative to the first.
struct MapperDrive {
  SyntheticWorld world = street();
  SyntheticWorld::Trajectory trajectory = driving;
  MapperConfig config;
  std::optional<Mapper> mapper;
  OdometryHistory odometry;
  Pose T_world_map = Pose::Identity();
  int turn = 0;

  explicit MapperDrive(const std::string& method = "icp") {
    config.method = method;
    world.noise = 0.01;
    mapper.emplace(config);
  }
  /// Odometry as the filter would give it, `scale` times the true distance.
  void with_odometry(double until, double scale = 1.0) {
    for (double t = -0.05; t < until; t += 0.01) {
      Pose T = trajectory(0).inverse() * trajectory(t);
      T.translation() *= scale;
      odometry.add({utime(t), T, true, false});
    }
  }
  Revolution next() {
    const int n = turn++;
    return revolution_of(world.packets(trajectory, config.vehicle.T_base_lidar(), n, n * kPeriod, kPeriod));
  }
  std::optional<MapperUpdate> step() { return step(next()); }
  std::optional<MapperUpdate> step(const Revolution& revolution) {
    const bool first = !mapper->started();
    auto update = mapper->process(revolution, odometry);
    if (update && first) T_world_map = truth(update->utime) * update->T_map_base.inverse();
    return update;
  }
  [[nodiscard]] Pose truth(std::int64_t t) const {
    return trajectory(static_cast<double>(t - SyntheticWorld::kEpoch) * 1e-6);
  }
  [[nodiscard]] double error(const MapperUpdate& update) const {
    return (truth(update.utime).inverse() * T_world_map * update.T_map_base).translation().norm();
  }
};

}  // namespace curbstone::test
