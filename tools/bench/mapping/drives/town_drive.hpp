#pragma once

#include <memory>

#include "tools/bench/mapping/drives/mapping_drive.hpp"
#include "tools/simulate/rig/drive.hpp"
#include "tools/simulate/rig/simulate_config.hpp"

namespace curbstone::bench::mapping::drives {

/// A drive around the block of the simulated town: the RS16's packets through our driver, IMU and wheels through our
/// filter.
class TownDrive final : public MappingDrive {
 public:
  struct Options {
    std::uint64_t seed = 1;
    double seconds = 40;
    double lidar_from = 0;  ///< s, time at which the LiDAR is switched on
    simulate::rig::SimulateConfig config = {};
  };
  /// Simulates the drive. Throws std::runtime_error if the temporary folder has no room for its log.
  explicit TownDrive(const Options& options);
  ~TownDrive() override;
  TownDrive(const TownDrive&) = delete;
  TownDrive& operator=(const TownDrive&) = delete;

  void play(const Take& take) const override;
  [[nodiscard]] const evaluate::truth::Trajectory& truth() const override { return truth_; }
  /// Leaves out the IMU and the wheels.
  void without_odometry() { prior = "none"; }

 private:
  std::string log_;
  std::int64_t lidar_from_;  // us
  evaluate::truth::Trajectory truth_;
};

}  // namespace curbstone::bench::mapping::drives
