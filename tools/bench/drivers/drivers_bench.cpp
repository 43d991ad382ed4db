#include "tools/bench/drivers/drivers_bench.hpp"

#include <fmt/format.h>

#include <exception>
#include <string>
#include <vector>

#include "common/config/command_line.hpp"
#include "tools/bench/drivers/drivers_report.hpp"

namespace curbstone::bench::drivers {

namespace {

struct DriversBenchOptions {
  std::vector<std::string> captures;
  double seconds = 2;
  timing::TurnOptions turns;
  std::string json;
};

DriversReport measure_drivers(const DriversBenchOptions& o) {
  using lidar::models::ModelName;
  DriversReport report;
  for (const ModelName model : {ModelName::kRs16, ModelName::kVlp16, ModelName::kHelios16p, ModelName::kHelios32})
    report.lidars.push_back(measure(emulated_packets(model, o.seconds), o.turns));
  for (const std::string& file : o.captures) report.lidars.push_back(measure(captured_packets(file), o.turns));

  const double longer = 30 * o.seconds;  // these devices send less data
  for (const auto& [name, model] : {std::pair{"xsens", imu::Model::kXsens}, {"witmotion", imu::Model::kWitMotion}})
    report.streams.push_back(measure(name, model, imu_stream(model, longer), o.turns));
  report.streams.push_back(measure("zlac8015d", encoder_stream(longer), o.turns));
  return report;
}

}  // namespace

int run_bench_drivers(int argc, char** argv) {
  DriversBenchOptions options;
  CommandLine line(
      "Packets, bytes and frames a second of the drivers on one core, beside a memcpy of the same bytes. No sockets, "
      "no "
      "serial ports",
      "curbstone bench drivers");
  line.option("--capture", options.captures, "A capture (.pcap, .pcapng) of a LiDAR, beside the emulated ones")
      .one_each();
  line.option("--seconds", options.seconds, "Of each emulated LiDAR; of the other devices thirty times that")
      .within(0.1, 60.0)
      .shows_default();
  line.option("--rounds", options.turns.rounds, "In which each has its turn; the median counts")
      .within(1, 1000)
      .shows_default();
  line.option("--min-time", options.turns.min_time, "s that a turn lasts at least").within(0.001, 60.0).shows_default();
  line.option("--json", options.json, "Write the figures to this file too");
  if (const auto status = line.read(argc, argv)) return *status;
  const DriversReport report = measure_drivers(options);
  print_report(report);
  if (!options.json.empty()) write_report(report, options.json);
  return 0;
}

}  // namespace curbstone::bench::drivers
