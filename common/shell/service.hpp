#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/node.hpp"
#include "common/config/config.hpp"
#include "common/shell/event_loop.hpp"

namespace curbstone {

/// Facilities that the shell gives a process besides its node: for drivers that watch a socket or a serial port.
struct ServiceContext {
  std::string name;  ///< unique on the bus, from --name
  std::string url;   ///< URL of the bus
  Publisher& bus;
  Tappable& everything;  ///< the same bus: for a recorder
  EventLoop& loop;
  /// LcmBus::receive_large(): for a recorder. Call it before tapping the bus.
  std::function<void(std::vector<std::string> channels)> receive_large;
};

/// The identity of a process.
struct ServiceOptions {
  std::string section;      ///< section of the vehicle's file, and the name on the bus unless --name gives another
  SectionNames sections;    ///< all sections that the file may have: see load_config()
  std::string description;  ///< one line, for --help
  std::chrono::microseconds gather = std::chrono::milliseconds(2);  ///< LcmBus::gather()
  bool alone = false;  ///< a second one on the bus, under whatever name, is a fault: see SecondProcess
};

/// Builds the node of a process.
using MakeNode = std::function<std::unique_ptr<Node>(ServiceContext&)>;

/// Runs a node as a process until SIGINT or SIGTERM: parses the command line (--config FILE, --set KEY=VALUE, --lcm-url
/// URL, --name NAME, --dump-config, --version), opens the bus, ticks the node every 20 ms, sends SERVICE_STATUS at 1 Hz
/// and whenever a fault begins or ends, and calls Node::finish() at the end. Returns the exit status: 0 clean, 1 the
/// environment failed (one clear line on stderr), 2 wrong usage or configuration.
///
/// `make` builds the node. It may throw one clear line; ConfigError and std::invalid_argument are wrong settings.
int run_service(int argc, char** argv, const ServiceOptions& options, AnyConfig& config, const MakeNode& make);

template <class Config>
int run_service(int argc, char** argv, const ServiceOptions& options,
                const std::function<std::unique_ptr<Node>(const Config&, ServiceContext&)>& make) {
  ConfigOf<Config> config;
  return run_service(argc, argv, options, config, [&](ServiceContext& context) { return make(config.value, context); });
}

}  // namespace curbstone
