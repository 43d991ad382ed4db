#include "tools/calibrate/drive_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <curbstone/imu_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/service_status_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <stdexcept>

#include "common/bus/local_bus.hpp"
#include "common/log/log_reader.hpp"
#include "services/ekf/ekf_messages.hpp"
#include "services/ekf/ekf_node.hpp"
#include "services/mapper/mapper_node.hpp"
#include "tools/output/ordered_log.hpp"
#include "tools/output/watched_log.hpp"

namespace curbstone::calibrate {

namespace {

bool has_map_poses(const std::string& log) {
  LogReader reader(log);
  while (const auto event = reader.next())
    if (event->channel == "MAP_POSE") return true;
  return false;
}

/// The mapper that runs here makes a map of its own: journal and folder are the vehicle's.
mapper::config::MapperConfig own_mapper(const std::string& config_file, const recording::RecordedConfig& recorded) {
  mapper::config::MapperConfig config =
      recording::config_of<mapper::config::MapperConfig>("mapper", config_file, recorded, {}).value;
  config.journal.clear();
  config.folder.clear();
  config.mode = mapper::config::MapMode::kMap;
  return config;
}

/// Where the mapper that made MAP_POSE believed the LiDAR to be. A file given now may be another one.
Pose lidar_of_map_poses(const std::string& config_file, const recording::RecordedConfig& recorded) {
  if (recorded.sections.contains("mapper")) return recorded.vehicle().T_base_lidar();
  return recording::config_of<mapper::config::MapperConfig>("mapper", config_file, recorded, {})
      .value.vehicle.T_base_lidar();
}

/// A mapper that has corrected vehicle.lidar by itself: its poses are not those of the configured mounting, from which
/// the calibration goes on. It would find the wrong mounting right.
bool is_correction(const std::string& counter) {
  return counter == "lidar_turned" || counter == "lidar_turned_over";
}

/// Collects the messages of a bus.
class Collector {
 public:
  Collector(LocalBus& bus, const Pose& T_base_lidar) : T_base_lidar_(T_base_lidar) {
    bus.subscribe<imu_t>("IMU", [this](const imu_t& m) {
      if (ekf::why_refused(m) == nullptr && newer(data_.imu, m.utime)) data_.imu.push_back(ekf::sample_of(m));
    });
    bus.subscribe<wheels_t>("WHEELS", [this](const wheels_t& m) {
      if (ekf::why_refused(m) == nullptr && newer(data_.wheels, m.utime)) data_.wheels.push_back(ekf::sample_of(m));
    });
    bus.subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& m) { on(m); });
    bus.subscribe<service_status_t>("SERVICE_STATUS", [this](const service_status_t& m) { on(m); });
    bus.subscribe<odometry_t>("ODOMETRY", [this](const odometry_t& m) {
      const Eigen::Vector3d bias(m.gyro_bias);
      if (bias.allFinite()) data_.gyro_bias = bias;
    });
  }
  [[nodiscard]] CalibrationData take() { return std::move(data_); }
  /// Whether the mapper that made MAP_POSE said that it had corrected the LiDAR's mounting.
  [[nodiscard]] bool is_corrected() const { return is_corrected_; }

 private:
  template <class Sample>
  static bool newer(const std::vector<Sample>& samples, std::int64_t utime) {
    return samples.empty() || utime > samples.back().utime;
  }
  void on(const map_pose_t& m) {
    const Pose T_map_base = pose_from_arrays(m.map_base_position, m.map_base_orientation);
    const bool registered = (m.flags & map_pose_t::REGISTERED) != 0 && m.degenerate == 0;
    if (!registered || !is_finite(T_map_base) || !newer(data_.lidar, m.utime)) return;
    data_.lidar.push_back({m.utime, T_map_base * T_base_lidar_});
  }

  void on(const service_status_t& m) {
    for (std::size_t i = 0; m.service == "mapper" && i < m.counter_name.size(); ++i)
      is_corrected_ = is_corrected_ || (is_correction(m.counter_name[i]) && m.counter_value[i] > 0);
  }

  Pose T_base_lidar_;
  CalibrationData data_;
  bool is_corrected_ = false;
};

/// Empty if the mapper has used the LiDAR as configured; else what it said.
std::string correction_in(const NodeReport& report) {
  const auto& counters = report.counters.values();
  if (std::none_of(counters.begin(), counters.end(),
                   [](const auto& c) { return is_correction(c.first) && c.second > 0; }))
    return {};
  std::string said = "it is not mounted as configured";
  for (const std::string& fault : report.faults) {
    if (fault.find("is used so") != std::string::npos) said = fault;
  }
  return said;
}

}  // namespace

CalibrationData read_drive(const std::string& log, const std::string& config_file,
                           const recording::RecordedConfig& recorded, bool map_anew) {
  const mapper::config::MapperConfig mapper_config = own_mapper(config_file, recorded);
  const bool given = !map_anew && has_map_poses(log);
  LocalBus bus;
  Collector collector(bus, given ? lidar_of_map_poses(config_file, recorded) : mapper_config.vehicle.T_base_lidar());
  ekf::base::EkfConfig ekf_config = recording::config_of<ekf::base::EkfConfig>("ekf", config_file, recorded, {}).value;
  ekf_config.state_file.clear();  // would be of the vehicle's own drive
  ekf::EkfNode ekf(ekf_config, bus);
  mapper::MapperNode mapper(mapper_config, bus);
  ekf.connect(bus);
  if (!given) mapper.connect(bus);

  output::WatchedLog reader(log, "calibrate");
  const auto deliver = [&](const LogEvent& event) {
    bus.inject(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    bus.dispatch();
  };
  const auto wanted = [&](const std::string& channel) {
    return channel == "IMU" || channel == "WHEELS" || channel == (given ? "MAP_POSE" : "LIDAR_POINTS") ||
           (given && channel == "SERVICE_STATUS");
  };
  output::read_in_order(reader, wanted, deliver);
  ekf.finish();
  bus.dispatch();
  if (!given) mapper.finish();
  bus.dispatch();

  const std::string correction =
      given ? (collector.is_corrected() ? "its faults say how" : "") : correction_in(mapper.report());
  if (!correction.empty())
    throw std::runtime_error(
        fmt::format("{}: the mapper has corrected the mounting of the LiDAR ({}): correct vehicle.lidar "
                    "in a file for --config, and calibrate from that with --map-anew",
                    log, correction));
  CalibrationData data = collector.take();
  data.log_is_damaged = reader.damaged();
  if (data.imu.empty()) throw std::runtime_error(log + ": holds no IMU");
  if (data.wheels.empty()) throw std::runtime_error(log + ": holds no WHEELS");
  if (data.lidar.empty()) throw std::runtime_error(log + ": holds no LIDAR_POINTS that can be mapped, and no MAP_POSE");
  return data;
}

}  // namespace curbstone::calibrate
