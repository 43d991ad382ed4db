#include "common/shell/service.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <curbstone/service_config_t.hpp>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
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

/// A node with its bus and its loop.
class Process {
 public:
  Process(service_config_t config, const std::string& url, const std::string& hash, const ServiceOptions& options,
          const MakeNode& make)
      : config_(std::move(config)),
        bus_(url, LcmBus::WithoutRoute::kWait),
        context_{config_.service,
                 bus_.url(),
                 bus_,
                 bus_,
                 loop_,
                 [this](std::vector<std::string> channels) { bus_.receive_large(std::move(channels)); }},
        status_(config_.service, hash) {
    bus_.gather(options.gather);
    node_ = make(context_);
    node_->connect(bus_);
    watch_others(options);
    schedule();
  }

  /// Runs until a signal ends the loop.
  void run() {
    publish_status();
    publish_config();
    loop_.run();
  }

  /// Takes what has arrived before the end, and sends the rest.
  void finish() {
    for (int turn = 0; turn < kLastTurns; ++turn) bus_.handle(std::chrono::milliseconds(0));
    node_->finish();
    publish_status();
  }

 private:
  /// Another process of the same name is a fault; with `alone`, any of the same task.
  void watch_others(const ServiceOptions& options) {
    bus_.subscribe<service_status_t>("SERVICE_STATUS", [this](const service_status_t& m) { status_.on_status(m); },
                                     {100});
    if (!options.alone) return;
    bus_.subscribe<service_config_t>("CONFIG", [this](const service_config_t& m) { status_.on_config(m, config_); },
                                     {100});
  }

  void schedule() {
    loop_.watch(bus_.fd(), [this] {
      bus_.handle(std::chrono::milliseconds(0));
      node_->caught_up(wall_clock());
    });
    loop_.when_idle([this] { return node_->idle(wall_clock()); });
    loop_.every(std::chrono::milliseconds(20), [this] { tick(); });
    loop_.every(std::chrono::milliseconds(1000), [this] { publish_status(); });
    loop_.every(kLookPeriod, [this] {
      if (status_.faults_changed(report())) publish_status();
    });
    loop_.every(kConfigPeriod, [this] { publish_config(); });
    loop_.every(kMemoryPeriod, [] { return_unused_memory(); });
  }

  void tick() {
    const std::int64_t before = steady_clock(), now = wall_clock(), steps = clock_.steps();
    clock_.read(before, now, steady_clock());
    if (clock_.steps() != steps) node_->clock_was_set(clock_.recent().value_or(0));
    node_->tick(now);
  }

  [[nodiscard]] NodeReport report() const {
    NodeReport all = node_->report();
    if (auto fault = bus_.fault()) all.faults.push_back(std::move(*fault));
    return all;
  }

  void publish_status() { status_.publish(bus_, bus_.counters(), report()); }

  void publish_config() {
    config_.utime = wall_clock();
    bus_.publish("CONFIG", config_);
  }

  service_config_t config_;
  EventLoop loop_;
  LcmBus bus_;
  ServiceContext context_;
  StatusReporter status_;
  ClockStep clock_;
  std::unique_ptr<Node> node_;
};

/// What the command line of a service says.
struct Command {
  std::string file;  ///< the vehicle's
  std::vector<std::string> assignments;
  std::string url;   ///< of the bus
  std::string name;  ///< on the bus
  int nice = 0;
  bool dump = false;
};

/// Returns the exit status if the process is to end here.
std::optional<int> read(int argc, char** argv, const ServiceOptions& options, Command& command) {
  CommandLine line(options.description);
  line.option("--config", command.file, "The vehicle's YAML file; its section '" + options.section + "' is read");
  line.option("--set", command.assignments, "Set one value: KEY=VALUE, over the file").one_each();
  line.option("--lcm-url", command.url, "Bus; default $LCM_DEFAULT_URL, else " + std::string(LcmBus::kDefaultUrl));
  line.option("--name", command.name, "Name on the bus, unique").shows_default();
  line.option("--nice", command.nice, "Yields to programs with a lower one when all want to compute").within(0, 19);
  line.flag("--dump-config", command.dump, "Print the effective configuration and stop");
  return line.read(argc, argv);
}

/// Throws ConfigError.
void configure(const Command& command, const ServiceOptions& options, AnyConfig& config) {
  if (!command.file.empty()) load_config(command.file, options.section, options.sections, config);
  for (const std::string& assignment : command.assignments) set_config_value(assignment, config);
}

void run_to_the_end(Process& process, int nice) {
  process.run();
  if (nice != 0) set_niceness(0);  // the remaining work must end before the deputy's time-out
  process.finish();
}

}  // namespace

int run_service(int argc, char** argv, const ServiceOptions& options, AnyConfig& config, const MakeNode& make) {
  use_one_heap();
  Command command;
  command.name = options.section;
  if (const auto status = read(argc, argv, options, command)) return *status;
  const auto end = [&](const std::string& why, int status) {
    fmt::print(stderr, "{}: {}\n", options.section, why);
    return status;
  };
  try {
    configure(command, options, config);
  } catch (const ConfigError& error) {
    return end(error.what(), 2);
  }
  if (command.dump) {
    (void)std::fputs(dump_config(options.section, config).c_str(), stdout);  // a full disk is said at the end
    return 0;
  }
  if (command.nice != 0) set_niceness(command.nice);
  const std::string place = command.file.empty() ? "" : command.file + ": ";
  std::unique_ptr<Process> process;
  try {
    process = std::make_unique<Process>(config_message(command.name, options.section, config), command.url,
                                        config_hash(options.section, config), options, make);
  } catch (const ConfigError& error) {
    return end(place + error.what(), 2);
  } catch (const std::invalid_argument& error) {
    return end(place + error.what(), 2);
  } catch (const std::exception& error) {
    return end(error.what(), 1);
  }
  try {
    run_to_the_end(*process, command.nice);
  } catch (const std::exception& error) {
    return end(error.what(), 1);
  }
  return 0;
}

}  // namespace curbstone
