#include "common/shell/service.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <curbstone/service_config_t.hpp>
#include <curbstone/service_status_t.hpp>
#include <fstream>

#include "common/bus/lcm_bus.hpp"
#include "common/config/command_line.hpp"
#include "common/shell/fault_lines.hpp"
#include "common/shell/version.hpp"
#include "common/time/clock.hpp"

namespace curbstone {

namespace {

constexpr std::chrono::seconds kConfigPeriod{5};

std::int64_t cpu_time() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto us = [](const timeval& t) { return std::int64_t{t.tv_sec} * 1'000'000 + t.tv_usec; };
  return us(usage.ru_utime) + us(usage.ru_stime);
}

std::int64_t resident_memory() {
  std::ifstream statm("/proc/self/statm");
  std::int64_t total = 0;
  std::int64_t resident = 0;
  statm >> total >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

/// Who was started by a deputy is a session of its own, and between sessions only their groups' niceness counts
/// (sched(7), "autogroup").
void yield_to_others(int nice) {
  if (nice == 0) return;
  setpriority(PRIO_PROCESS, 0, nice);
  std::ofstream("/proc/self/autogroup") << nice;
}

std::string host_name() {
  char name[256] = {};
  gethostname(name, sizeof name - 1);
  return name;
}

/// What the process says of how it is configured: see service_config_t.
service_config_t config_message(const std::string& name, const std::string& section, AnyConfig& config) {
  service_config_t message;
  message.service = name;
  message.section = section;
  message.host = host_name();
  message.version = version();
  message.yaml = dump_config(section, config);
  return message;
}

class StatusReporter {
 public:
  StatusReporter(std::string service, std::string config_hash) {
    status_.service = std::move(service);
    status_.host = host_name();
    status_.pid = getpid();
    status_.version = version();
    status_.config_hash = std::move(config_hash);
  }

  void publish(LcmBus& bus, const NodeReport& report) {
    status_.utime = wall_clock();
    status_.uptime = steady_clock() - start_;
    status_.cpu_time = cpu_time();
    status_.memory = resident_memory();
    status_.latency_p50 = static_cast<float>(report.latency_p50);
    status_.latency_p99 = static_cast<float>(report.latency_p99);
    status_.counter_name.clear();
    status_.counter_value.clear();
    const Counters bus_counters = bus.counters();
    for (const Counters* counters : {&report.counters, &bus_counters}) {
      for (const auto& [name, value] : counters->values()) {
        status_.counter_name.push_back(name);
        status_.counter_value.push_back(value);
      }
    }
    status_.num_counters = static_cast<std::int32_t>(status_.counter_name.size());
    status_.fault = report.faults;
    status_.num_faults = static_cast<std::int32_t>(status_.fault.size());
    bus.publish("SERVICE_STATUS", status_);
    for (const std::string& line : fault_lines_.update(report.faults, steady_clock()))
      fmt::print(stderr, "{}: {}\n", status_.service, line);
  }

 private:
  service_status_t status_;
  FaultLines fault_lines_;
  std::int64_t start_ = steady_clock();
};

void run(service_config_t config, const std::string& url, const std::string& hash,
         const std::function<std::unique_ptr<Node>(ServiceContext&)>& make) {
  EventLoop loop;
  LcmBus bus(url);
  ServiceContext context{config.service, bus, bus, loop};
  const std::unique_ptr<Node> node = make(context);
  node->connect(bus);
  StatusReporter status(config.service, hash);
  const auto publish_config = [&] {
    config.utime = wall_clock();
    bus.publish("CONFIG", config);
  };

  loop.watch(bus.fd(), [&] {
    bus.handle(std::chrono::milliseconds(0));
    node->caught_up(wall_clock());
  });
  loop.when_idle([&] { return node->idle(wall_clock()); });
  loop.every(std::chrono::milliseconds(20), [&] { node->tick(wall_clock()); });
  loop.every(std::chrono::milliseconds(1000), [&] { status.publish(bus, node->report()); });
  loop.every(kConfigPeriod, publish_config);
  status.publish(bus, node->report());
  publish_config();
  loop.run();

  bus.handle(std::chrono::milliseconds(0));
  node->finish();
  status.publish(bus, node->report());
}

}  // namespace

std::string version() {
  return CURBSTONE_VERSION_TEXT;
}

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
  line.version(version());
  if (const auto status = line.read(argc, argv)) return *status;
  try {
    if (!file.empty()) load_config(file, section, options.sections, config);
    for (const std::string& assignment : assignments) set_config_value(assignment, config);
    if (dump) {
      fmt::print("{}", dump_config(section, config));
      return 0;
    }
  } catch (const ConfigError& error) {
    fmt::print(stderr, "{}: {}\n", section, error.what());
    return 2;
  }
  try {
    yield_to_others(nice);
    run(config_message(name, section, config), url, config_hash(section, config), make);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", section, error.what());
    return 1;
  }
  return 0;
}

}  // namespace curbstone
