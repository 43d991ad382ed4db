#include "services/mapper/detection/sensor_monitor.hpp"

namespace curbstone::mapper::detection {

void SensorMonitor::clean(scan::Scan& scan) {
  const bool moved = (position_ - looked_).norm() >= returns::LaserElevations::kStep;
  if (moved) looked_ = position_;
  if (moved) sectors_.check(scan);
  steps_.check(scan);
  dead_.check(scan, moved);
  intensity_.check(scan);
  ground_.check(scan, moved);
  strays_.filter(scan);
  lasers_.check(scan, moved);
  if (lasers_.any_wrong()) lasers_.withhold(scan);
}

void SensorMonitor::add(const mounting::RegisteredScan& scan) {
  position_ = scan.T_map_base.translation();
  mounting_.add(scan);
  if (!scan.T_odom_base) {
    turns_.interrupt();
    lean_.interrupt();
    return;
  }
  turns_.add(scan.utime, scan.T_map_base, *scan.T_odom_base);
  lean_.add(scan.utime, scan.T_map_base, *scan.T_odom_base);
}

void SensorMonitor::interrupt() {
  mounting_.interrupt();
  turns_.interrupt();
  lean_.interrupt();
}

void SensorMonitor::compare(std::int64_t utime, const Pose& T_map_base_by_scan, const Pose& T_odom_base) {
  lag_.add(utime, T_map_base_by_scan, T_odom_base);
}

void SensorMonitor::add_faults(std::vector<std::string>& faults) const {
  lasers_.add_faults(faults);
  strays_.add_faults(faults);
  mounting_.add_faults(faults);
  turns_.add_faults(faults);
  lean_.add_faults(faults);
  lag_.add_faults(faults);
  sectors_.add_faults(faults);
  silence_.add_faults(faults);
  steps_.add_faults(faults);
  dead_.add_faults(faults);
  intensity_.add_faults(faults);
  ground_.add_faults(faults);
}

void SensorMonitor::add_counters(Counters& counters) const {
  for (const Counters* part : {&strays_.counters(), &lasers_.counters(), &mounting_.counters(), &turns_.counters(),
                               &lean_.counters(), &lag_.counters(), &sectors_.counters(), &ground_.counters(),
                               &steps_.counters(), &dead_.counters(), &intensity_.counters()})
    counters.add(*part);
}

}  // namespace curbstone::mapper::detection
