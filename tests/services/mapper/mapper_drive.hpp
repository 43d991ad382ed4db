#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "services/mapper/mapper.hpp"
#include "services/mapper/scan/scan_assembler.hpp"
#include "tests/services/mapper/synthetic_world.hpp"

namespace curbstone::test {

inline constexpr double kPeriod = 0.05;                  // s
inline constexpr double kDegree = 0.017453292519943295;  // rad

inline std::int64_t utime(double seconds) {
  return SyntheticWorld::kEpoch + std::llround(seconds * 1e6);
}

/// A vehicle at 3 m/s on a gentle curve.
inline Pose driving(double t) {
  return pose(-10, 0, 0, 0, 0, 0) * mapper::scan::move({{3, 0, 0}, {0, 0, 0.05}}, t);
}

inline mapper::scan::Scan scan_of(const std::vector<lidar_points_t>& packets) {
  mapper::scan::ScanAssembler assembler;
  for (const lidar_points_t& packet : packets) (void)assembler.add(packet);
  return *assembler.flush();
}

/// A mapper on a synthetic drive; poses are compared with the truth relative to the first.
struct MapperDrive {
  SyntheticWorld world = street();
  SyntheticWorld::Trajectory trajectory = driving;
  mapper::config::MapperConfig config;
  std::optional<mapper::Mapper> mapper;
  mapper::scan::OdometryHistory odometry;
  Pose T_world_map = Pose::Identity();
  int turn = 0;

  explicit MapperDrive(const std::string& method = "icp") {
    config.registration.method =
        method == "loam" ? mapper::config::RegistrationMethod::kLoam : mapper::config::RegistrationMethod::kIcp;
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
  mapper::scan::Scan next() {
    const int n = turn++;
    return scan_of(world.packets(trajectory, config.vehicle.T_base_lidar(), n, n * kPeriod, kPeriod));
  }
  std::optional<mapper::MapperUpdate> step() { return step(next()); }
  std::optional<mapper::MapperUpdate> step(const mapper::scan::Scan& scan) {
    const bool first = !mapper->started();
    auto update = mapper->process(scan, odometry);
    if (update && first) T_world_map = truth(update->utime) * update->T_map_base.inverse();
    return update;
  }
  /// With all that has been driven.
  [[nodiscard]] const mapper::dense_map::DenseMap& dense() {
    mapper->wait();
    return mapper->dense();
  }
  [[nodiscard]] Pose truth(std::int64_t t) const {
    return trajectory(static_cast<double>(t - SyntheticWorld::kEpoch) * 1e-6);
  }
  [[nodiscard]] double error(const mapper::MapperUpdate& update) const {
    return (truth(update.utime).inverse() * T_world_map * update.T_map_base).translation().norm();
  }
};

}  // namespace curbstone::test
