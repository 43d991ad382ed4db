#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/bus.hpp"
#include "common/config.hpp"
#include "common/event_loop.hpp"
#include "common/node.hpp"

namespace curbstone {

/// What the shell gives to a process besides its node: for drivers that watch a socket or a serial port.
struct ServiceContext {
  std::string name;  ///< unique on the bus, from --name
  Publisher& bus;
  Tappable& everything;  ///< the same bus: for a recorder
  EventLoop& loop;
};

/// Runs a node as a process until SIGINT or SIGTERM: parses the command line (--config FILE, --set KEY=VALUE,
/// --lcm-url URL, --name NAME, --dump-config, --version), opens the bus, ticks the node every 20 ms, sends
/// SERVICE_STATUS at 1 Hz, calls Node::finish() at the end. Returns the exit status: 0 clean, 1 the environment failed
/// (one clear line on stderr), 2 wrong usage or configuration.
///
/// `make` builds the node from the loaded configuration. It may throw std::runtime_error with one clear line.
int run_service(int argc, char** argv, const std::string& section, const std::string& description, AnyConfig& config,
                const std::function<std::unique_ptr<Node>(ServiceContext&)>& make);

template <class Config>
int run_service(int argc, char** argv, const std::string& section, const std::string& description,
                const std::function<std::unique_ptr<Node>(const Config&, ServiceContext&)>& make) {
  ConfigOf<Config> config;
  return run_service(argc, argv, section, description, config,
                     [&](ServiceContext& context) { return make(config.value, context); });
}

}  // namespace curbstone
