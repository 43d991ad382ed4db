#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/detection/lidar_silence.hpp"
#include "services/mapper/detection/range_scale.hpp"
#include "services/mapper/detection/turn_sense.hpp"
#include "services/mapper/mounting/lidar_lag.hpp"
#include "services/mapper/mounting/lidar_mounting.hpp"
#include "services/mapper/mounting/map_lean.hpp"
#include "services/mapper/mounting/turn_agreement.hpp"
#include "services/mapper/returns/blind_sectors.hpp"
#include "services/mapper/returns/dead_lasers.hpp"
#include "services/mapper/returns/flat_intensity.hpp"
#include "services/mapper/returns/ground_in_sight.hpp"
#include "services/mapper/returns/laser_alignment.hpp"
#include "services/mapper/returns/laser_elevations.hpp"
#include "services/mapper/returns/laser_order.hpp"
#include "services/mapper/returns/range_steps.hpp"
#include "services/mapper/returns/sight_range.hpp"
#include "services/mapper/returns/stray_returns.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::detection {

/// Checks the sensors by the revolutions. Points known to be wrong are removed from a revolution before any other use;
/// without a fault every point is kept.
class SensorMonitor {
 public:
  explicit SensorMonitor(const VehicleConfig& vehicle)
      : order_(vehicle.T_base_lidar()),
        mounting_(vehicle),
        sight_(vehicle.T_base_lidar()),
        ground_(vehicle.T_base_lidar()),
        scale_(vehicle.T_base_lidar().translation().z()) {}

  /// Called every 20 ms, `now` in us; and for each packet of the LiDAR.
  void tick(std::int64_t now) { silence_.tick(now); }
  void heard() { silence_.heard(); }
  /// Takes the next revolution, in lidar, and removes wrong points.
  void clean(scan::Scan& scan);
  /// Reports that the revolution fitted the map.
  void add(const mounting::RegisteredScan& scan);
  /// Reports that the revolution did not fit, or that the map was rearranged.
  void interrupt();
  /// Takes the poses of the next revolution by registration, accepted or not, and by odometry.
  void compare(std::int64_t utime, const Pose& T_map_base_by_scan, const Pose& T_odom_base);
  /// Reports that poses from now on are in another map.
  void begin_map() {
    lag_.interrupt();
    sense_.interrupt();
  }

  /// See GroundInSight.
  [[nodiscard]] bool is_upside_down() const { return ground_.is_upside_down(); }
  void add_faults(std::vector<std::string>& faults) const;
  void add_counters(Counters& counters) const;

 private:
  returns::StrayReturns strays_;
  returns::LaserElevations lasers_;
  returns::LaserOrder order_;
  returns::LaserAlignment alignment_;
  mounting::LidarMounting mounting_;
  mounting::TurnAgreement turns_;
  mounting::MapLean lean_;
  mounting::LidarLag lag_;
  returns::BlindSectors sectors_;
  returns::RangeSteps steps_;
  returns::DeadLasers dead_;
  returns::FlatIntensity intensity_;
  LidarSilence silence_;
  returns::SightRange sight_;
  returns::GroundInSight ground_;
  RangeScale scale_;
  TurnSense sense_;
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();  // m, map: of the last revolution that fitted,
  Eigen::Vector3d looked_ = Eigen::Vector3d::Zero();    // of the last check of the lasers on the move,
  Eigen::Vector3d compared_ = Eigen::Vector3d::Zero();  // and of the last comparison of one laser with others
};

}  // namespace curbstone::mapper::detection
