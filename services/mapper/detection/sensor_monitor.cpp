#include "services/mapper/detection/sensor_monitor.hpp"

namespace curbstone::mapper::detection {

namespace {

constexpr double kCompareEvery = 1.0;  // m of way

}  // namespace

void SensorMonitor::clean(scan::Scan& scan) {
  const bool moved = (position_ - looked_).norm() >= returns::LaserElevations::kStep;
  if (moved) looked_ = position_;
  if (moved) sectors_.check(scan);
  if (moved) sight_.check(scan);
  steps_.check(scan);
  dead_.check(scan, moved);
  intensity_.check(scan);
  ground_.check(scan, moved);
  strays_.filter(scan);
  lasers_.check(scan, moved);
  if ((position_ - compared_).norm() >= kCompareEvery) {
    compared_ = position_;
    const auto distances = returns::level_distances(scan);
    order_.check(distances);
    alignment_.check(distances);
  }
  if (lasers_.any_wrong()) lasers_.withhold(scan);
  if (order_.any_wrong()) order_.withhold(scan);
  if (alignment_.any_wrong()) alignment_.withhold(scan);
}

void SensorMonitor::add(const mounting::RegisteredScan& scan) {
  position_ = scan.T_map_base.translation();
  mounting_.add(scan);
  scale_.add(scan);
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
  scale_.interrupt();
  turns_.interrupt();
  lean_.interrupt();
}

void SensorMonitor::compare(std::int64_t utime, const Pose& T_map_base_by_scan, const Pose& T_odom_base) {
  lag_.add(utime, T_map_base_by_scan, T_odom_base);
  sense_.add(utime, T_map_base_by_scan, T_odom_base);
  mounting_.set_turns_opposite(sense_.is_opposite());
  mounting_.set_stamps_are_wrong(lag_.wrong());
}

void SensorMonitor::add_faults(std::vector<std::string>& faults) const {
  lasers_.add_faults(faults);
  order_.add_faults(faults);
  alignment_.add_faults(faults);
  strays_.add_faults(faults);
  scale_.add_faults(faults);
  mounting_.add_faults(faults);
  // What a known cause explains is not reported beside it.
  const bool is_mirrored = mounting_.wrong().mirrored;
  if (!is_mirrored) turns_.add_faults(faults);
  lean_.add_faults(faults);
  if (!is_mirrored) lag_.add_faults(faults);
  sectors_.add_faults(faults);
  sight_.add_faults(faults);
  silence_.add_faults(faults);
  steps_.add_faults(faults);
  dead_.add_faults(faults);
  intensity_.add_faults(faults);
  if (!scale_.scale()) ground_.add_faults(faults);
}

void SensorMonitor::add_counters(Counters& counters) const {
  for (const Counters* part :
       {&strays_.counters(), &lasers_.counters(), &order_.counters(), &alignment_.counters(), &mounting_.counters(),
        &turns_.counters(), &lean_.counters(), &lag_.counters(), &sectors_.counters(), &ground_.counters(),
        &steps_.counters(), &dead_.counters(), &intensity_.counters(), &sight_.counters(), &scale_.counters()})
    counters.add(*part);
}

}  // namespace curbstone::mapper::detection
