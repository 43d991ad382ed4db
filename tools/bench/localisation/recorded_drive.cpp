#include "tools/bench/localisation/recorded_drive.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/bus/local_bus.hpp"
#include "services/ekf/ekf_node.hpp"
#include "tools/output/ordered_log.hpp"
#include "tools/output/watched_log.hpp"

namespace curbstone::bench::localisation {

std::int64_t time_of(const DriveMessage& message) {
  return std::visit([](const auto& m) { return m.utime; }, message);
}

RecordedDrive::RecordedDrive(const std::string& log, const ekf::base::EkfConfig& config) {
  output::WatchedLog reader(log, "bench localisation");
  LocalBus bus;
  ekf::EkfNode ekf(config, bus);
  ekf.connect(bus);
  bus.subscribe<lidar_points_t>("LIDAR_POINTS", [&](const lidar_points_t& m) { messages_.emplace_back(m); });
  bus.subscribe<odometry_t>("ODOMETRY", [&](const odometry_t& m) {
    messages_.emplace_back(m);
    odometry_.push_back(m);
  });
  const auto deliver = [&](const LogEvent& event) {
    bus.inject(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    bus.dispatch();
  };
  output::read_in_order(reader, output::is_of_a_driver, deliver);
  ekf.finish();
  bus.dispatch();
  if (odometry_.empty()) throw std::runtime_error(log + ": gives no odometry: IMU and WHEELS?");
  driven_.push_back(0);
  for (std::size_t i = 1; i < odometry_.size(); ++i) {
    const double* a = odometry_[i - 1].position;
    const double* b = odometry_[i].position;
    driven_.push_back(driven_.back() + std::hypot(b[0] - a[0], b[1] - a[1]));
  }
}

std::size_t RecordedDrive::first_at(std::int64_t utime) const {
  const auto at = std::find_if(messages_.begin(), messages_.end(), [&](const auto& m) { return time_of(m) >= utime; });
  return static_cast<std::size_t>(at - messages_.begin());
}

std::size_t RecordedDrive::nearest(std::int64_t utime) const {
  const auto earlier = [](const odometry_t& m, std::int64_t t) { return m.utime < t; };
  const auto at = std::lower_bound(odometry_.begin(), odometry_.end(), utime, earlier);
  return static_cast<std::size_t>(std::min(at, odometry_.end() - 1) - odometry_.begin());
}

const odometry_t& RecordedDrive::odometry_at(std::int64_t utime) const {
  return odometry_[nearest(utime)];
}

double RecordedDrive::driven_at(std::int64_t utime) const {
  return driven_[nearest(utime)];
}

}  // namespace curbstone::bench::localisation
