#include "common/shell/service.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <curbstone/service_config_t.hpp>
#include <fstream>
#include <utility>

#include "common/bus/lcm_bus.hpp"
#include "common/config/command_line.hpp"
#include "common/config/version.hpp"
#include "common/shell/process_memory.hpp"
#include "common/shell/status_reporter.hpp"
#include "common/time/clock.hpp"
#include "common/time/clock_step.hpp"

namespace curbstone {

namespace {

constexpr std::chrono::seconds kConfigPeriod{5};
constexpr std::chrono::seconds kMemoryPeriod{10};
constexpr std::chrono::milliseconds kLookPeriod{200};  // of checks whether a fault has begun or ended

constexpr int kLastTurns = 10;  // calls of handle() for messages that arrived before the end

/// Sets the niceness of the process and of its session. Each process that a deputy starts is a session of its own, and
/// between sessions only the niceness of the session counts (sched(7), "autogroup").
void set_niceness(int nice) {
  setpriority(PRIO_PROCESS, 0, nice);
  std::ofstream("/proc/self/autogroup") << nice;
}

/// The message that publishes the process's configuration: see service_config_t.
service_config_t config_message(const std::string& name, const std::string& section, AnyConfig& config) {
  service_config_t message;
  message.service = name;
  message.section = section;
  message.host = host_name();
  message.version = version();
  message.yaml = dump_config(section, config);
  return message;
}

void run(service_config_t config, const std::string& url, const std::string& hash, int nice,
         const ServiceOptions& options, const std::function<std::unique_ptr<Node>(ServiceContext&)>& make) {
  if (nice != 0) set_niceness(nice);
  EventLoop loop;
  LcmBus bus(url, LcmBus::WithoutRoute::kWait);
  bus.gather(options.gather);
  ServiceContext context{config.service, bus.url(), bus, bus, loop, [&bus](std::vector<std::string> channels) {
                           bus.receive_large(std::move(channels));
                         }};
  const std::unique_ptr<Node> node = make(context);
  node->connect(bus);
  StatusReporter status(config.service, hash);
  bus.subscribe<service_status_t>("SERVICE_STATUS", [&status](const service_status_t& m) { status.on_status(m); },
                                  {100});
  if (options.alone)
    bus.subscribe<service_config_t>("CONFIG", [&](const service_config_t& m) { status.on_config(m, config); }, {100});
  const auto publish_config = [&] {
    config.utime = wall_clock();
    bus.publish("CONFIG", config);
  };

  loop.watch(bus.fd(), [&] {
    bus.handle(std::chrono::milliseconds(0));
    node->caught_up(wall_clock());
  });
  loop.when_idle([&] { return node->idle(wall_clock()); });
  ClockStep clock;
  loop.every(std::chrono::milliseconds(20), [&] {
    const std::int64_t before = steady_clock(), now = wall_clock(), steps = clock.steps();
    clock.read(before, now, steady_clock());
    if (clock.steps() != steps) node->clock_was_set(clock.recent().value_or(0));
    node->tick(now);
  });
  const auto report = [&] {
    NodeReport all = node->report();
    if (auto fault = bus.fault()) all.faults.push_back(std::move(*fault));
    return all;
  };
  const auto publish_status = [&] { status.publish(bus, bus.counters(), report()); };
  loop.every(std::chrono::milliseconds(1000), publish_status);
  loop.every(kLookPeriod, [&] {
    if (status.faults_changed(report())) publish_status();
  });
  loop.every(kConfigPeriod, publish_config);
  loop.every(kMemoryPeriod, [] { return_unused_memory(); });
  publish_status();
  publish_config();
  loop.run();

  if (nice != 0) set_niceness(0);  // the remaining work must end before the deputy's time-out
  for (int turn = 0; turn < kLastTurns; ++turn) bus.handle(std::chrono::milliseconds(0));
  node->finish();
  publish_status();
}

}  // namespace

int run_service(int argc, char** argv, const ServiceOptions& options, AnyConfig& config,
                const std::function<std::unique_ptr<Node>(ServiceContext&)>& make) {
  const std::string& section = options.section;
  CommandLine line(options.description);
  std::string file;
  std::string url;
  std::string name = section;
  std::vector<std::string> assignments;
  int nice = 0;
  bool dump = false;
  line.option("--config", file, "The vehicle's YAML file; its section '" + section + "' is read");
  line.option("--set", assignments, "Set one value: KEY=VALUE, over the file").one_each();
  line.option("--lcm-url", url, "Bus; default $LCM_DEFAULT_URL, else " + std::string(LcmBus::kDefaultUrl));
  line.option("--name", name, "Name on the bus, unique").shows_default();
  line.option("--nice", nice, "Yields to programs with a lower one when all want to compute").within(0, 19);
  line.flag("--dump-config", dump, "Print the effective configuration and stop");
  if (const auto status = line.read(argc, argv)) return *status;
  try {
    if (!file.empty()) load_config(file, section, options.sections, config);
    for (const std::string& assignment : assignments) set_config_value(assignment, config);
    if (dump) {
      (void)std::fputs(dump_config(section, config).c_str(), stdout);  // a full disk is said at the end
      return 0;
    }
  } catch (const ConfigError& error) {
    fmt::print(stderr, "{}: {}\n", section, error.what());
    return 2;
  }
  try {
    run(config_message(name, section, config), url, config_hash(section, config), nice, options, make);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", section, error.what());
    return 1;
  }
  return 0;
}

}  // namespace curbstone
