#include "tools/doctor/doctor.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <thread>

#include "common/config/command_line.hpp"
#include "common/terminal/screen.hpp"
#include "tools/doctor/facts/bus_facts.hpp"
#include "tools/doctor/facts/bus_probe.hpp"
#include "tools/doctor/facts/host_facts.hpp"
#include "tools/doctor/facts/lidar_facts.hpp"
#include "tools/doctor/facts/vehicle_facts.hpp"
#include "tools/doctor/report.hpp"

namespace curbstone::doctor {

namespace {

constexpr double kUsualRate = 9e6;    // bytes/s of a recording: docs/deployment.md, "Record and replay"
constexpr double kDrivingRate = 1e5;  // below this rate on the bus, no drive is going on

std::string default_config() {
  const char* const file = std::getenv("CURBSTONE_CONFIG");
  return file != nullptr && *file != '\0' ? file : "/etc/curbstone/ugv.yaml";
}

void append(checks::Verdicts& all, checks::Verdicts more) {
  all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

std::int64_t messages_on(const checks::BusProbeFacts& probe, const std::string& channel) {
  const auto found = probe.messages.find(channel);
  return found == probe.messages.end() ? 0 : found->second;
}

/// Probes the bus and the LiDAR's port at the same time.
checks::Verdicts examine(const std::string& url, const std::string& config, const std::string& procman,
                         double seconds) {
  facts::VehicleWishes wishes = facts::read_vehicle(config, procman);
  checks::BusFacts bus;
  bus.url = facts::bus_url(url);
  const auto address = parse_bus_url(bus.url);
  std::thread wire([&] {
    if (!wishes.lidar_port) return;
    wishes.facts.lidar = facts::probe_lidar(*wishes.lidar_port, seconds);
    wishes.facts.lidar->wanted_sender = wishes.lidar_address;
  });
  if (address) {
    bus.route = facts::read_route(address->group);
    bus.probe = facts::probe_bus(*address, seconds, wishes.unrecorded_channel);
  }
  wire.join();
  if (wishes.facts.lidar) wishes.facts.lidar->messages = messages_on(bus.probe, "LIDAR_POINTS");
  wishes.facts.stale = facts::stale_services(wishes, config, bus.probe.config_hashes);
  wishes.facts.disk = facts::read_disk(wishes.recorder_folder);
  if (wishes.facts.disk) {
    const double rate = static_cast<double>(bus.probe.bytes) / seconds;
    wishes.facts.disk->is_measured = rate > kDrivingRate;
    wishes.facts.disk->rate = wishes.facts.disk->is_measured ? rate : kUsualRate;
  }
  checks::Verdicts verdicts = checks::check_bus(bus);
  append(verdicts, checks::check_vehicle(wishes.facts));
  append(verdicts, checks::check_host(facts::read_host()));
  return verdicts;
}

}  // namespace

int run_doctor(int argc, char** argv) {
  std::string config = default_config(), procman = "/etc/curbstone/ugv.cfg", url;
  double seconds = 1.5;
  bool json = false;
  CommandLine line(
      "What is wrong with this vehicle's PC, and how to mend it. A line a check; exit status 1: something is.",
      "curbstone doctor");
  line.option("--config", config, "The vehicle's YAML file").shows_default();
  line.option("--procman", procman, "What the deputy runs").shows_default();
  line.option("--lcm-url", url, "Bus; default $LCM_DEFAULT_URL, else loopback");
  line.option("--seconds", seconds, "How long to listen to the bus and to the LiDAR").within(0.1, 60.0).shows_default();
  line.flag("--json", json, "For programs");
  if (const auto status = line.read(argc, argv)) return *status;
  const checks::Verdicts verdicts = examine(url, config, procman, seconds);
  if (json) {
    fmt::print("{}\n", report_json(verdicts));
  } else {
    for (const std::string& text : report_lines(verdicts, Screen(STDOUT_FILENO).style())) fmt::print("{}\n", text);
  }
  return exit_status(verdicts);
}

}  // namespace curbstone::doctor
