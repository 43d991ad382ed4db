#include "tools/calibrate/calibrate.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "common/config/command_line.hpp"
#include "common/config/vehicle.hpp"
#include "tools/calibrate/calibration.hpp"
#include "tools/calibrate/drive_data.hpp"
#include "tools/output/inputs.hpp"
#include "tools/output/text_file.hpp"
#include "tools/recording/recorded_config.hpp"

namespace curbstone::calibrate {

namespace {

constexpr double kDegrees = 57.29577951308232;

std::string shown(const CalibratedValue& v, double x) {
  return v.unit == "rad" ? fmt::format("{:9.3f} deg", x * kDegrees) : fmt::format("{:9.5f} m  ", x);
}

void print(const CalibrationResult& result) {
  fmt::print(
      "{} pieces of drive, {:.1f} m, {:.0f} deg of turning; wheels against LiDAR {:.1f} mm, gyro {:.2f} mrad, "
      "accelerometer {:.0f} mm/s\n\n",
      result.segments, result.distance, result.turned * kDegrees, 1e3 * result.noise[0], 1e3 * result.noise[1],
      1e3 * result.noise[2]);
  fmt::print("  {:<20} {:>13} {:>13} {:>13}\n", "", "configured", "found", "1 sigma");
  for (const CalibratedValue& v : result.values) {
    fmt::print("  {:<20} {} {} {}  {}\n", v.name, shown(v, v.configured), shown(v, v.value), shown(v, v.sigma),
               v.observed      ? ""
               : v.share > 0.9 ? "not well enough: kept"
                               : "not observed by this drive: kept");
  }
  for (const OpenDirection& direction : result.open) {
    std::string parts;
    for (const auto& [name, part] : direction.parts) parts += fmt::format(" {:+.1f} {}", part, name);
    fmt::print("  nothing known along:{}\n", parts);
  }
  std::string kept;
  for (const CalibratedValue& v : result.values)
    if (!v.observed) kept += (kept.empty() ? "" : ", ") + v.name;
  fmt::print("\nverdict: {}\n", kept.empty() ? "this drive tells everything"
                                             : "this drive does not tell " + kept + ": they stay as configured");
}

std::string yaml(const CalibrationResult& result) {
  const auto list = [](const std::vector<double>& xyzrpy) {
    return fmt::format("[{:.4f}, {:.4f}, {:.4f}, {:.5f}, {:.5f}, {:.5f}]", xyzrpy[0], xyzrpy[1], xyzrpy[2], xyzrpy[3],
                       xyzrpy[4], xyzrpy[5]);
  };
  const VehicleConfig& v = result.vehicle;
  return fmt::format(
      "vehicle:\n  wheel_radius: {:.5f}  # left {:.5f}, right {:.5f}\n  track_width: {:.4f}\n  width: {}\n"
      "  length: {}\n  middle: {}\n  height: {}\n  lidar: {}\n  imu: {}\n",
      v.wheel_radius, result[Calibrated::kRadiusLeft].value, result[Calibrated::kRadiusRight].value, v.track_width,
      v.width, v.length, v.middle, v.height, list(v.lidar), list(v.imu));
}

nlohmann::json json(const CalibrationResult& result) {
  nlohmann::json out;
  out["segments"] = result.segments;
  out["distance_m"] = result.distance;
  out["turned_rad"] = result.turned;
  for (const CalibratedValue& v : result.values) {
    out["parameters"].push_back({{"name", v.name},
                                 {"unit", v.unit},
                                 {"configured", v.configured},
                                 {"value", v.value},
                                 {"sigma", v.sigma},
                                 {"share", v.share},
                                 {"observed", v.observed}});
  }
  out["open"] = nlohmann::json::array();
  for (const OpenDirection& direction : result.open) {
    nlohmann::json parts = nlohmann::json::object();
    for (const auto& [name, part] : direction.parts) parts[name] = part;
    out["open"].push_back(parts);
  }
  for (Eigen::Index row = 0; row < result.covariance.rows(); ++row) {
    std::vector<double> numbers;
    for (Eigen::Index column = 0; column < result.covariance.cols(); ++column)
      numbers.push_back(result.covariance(row, column));
    out["covariance"].push_back(numbers);
  }
  return out;
}

}  // namespace

int run_calibrate(int argc, char** argv) {
  std::string log, config_file, yaml_file, json_file;
  bool map_anew = false;
  CommandLine line("Wheel radii, track and the places of LiDAR and IMU from a drive, and what the drive could not tell",
                   "curbstone calibrate");
  line.argument("log", log, "Log with IMU, WHEELS, and LIDAR_POINTS or MAP_POSE").required();
  line.option("--config", config_file,
              "The vehicle's YAML file: where to start from, instead of what the log was recorded with");
  line.flag("--map-anew", map_anew, "Run filter and mapper even if the log holds MAP_POSE");
  line.option("--out", yaml_file, "Write the vehicle: section to this file instead of standard output");
  line.option("--json", json_file, "Write everything to this file");
  if (const auto status = line.read(argc, argv)) return *status;
  for (const std::string& file : {yaml_file, json_file}) output::refuse_to_overwrite({log, config_file}, file);
  LogFiles head({log});
  const recording::RecordedConfig recorded = recording::recorded_config(head);
  const VehicleConfig vehicle = recording::vehicle_of(config_file, recorded);
  const CalibrationData data = read_drive(log, config_file, recorded, map_anew);
  const CalibrationResult result = calibrate(data, vehicle);
  fmt::print("configuration: {}\n", recording::source_of_configuration({"ekf", "mapper"}, config_file, recorded, {}));
  print(result);
  if (yaml_file.empty())
    fmt::print("\n{}", yaml(result));
  else
    output::write_text(yaml_file, yaml(result));
  if (!json_file.empty()) output::write_text(json_file, json(result).dump(2) + "\n");
  return data.log_is_damaged ? 1 : 0;
}

}  // namespace curbstone::calibrate
