#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "procman/config/config.hpp"
#include "procman/deputy/systemd_notify.hpp"
#include "procman/process/supervisor.hpp"

namespace curbstone::procman::deputy {

/// Commands that outlive a deputy that dies. systemd keeps their terminals while it restarts the deputy, so they do not
/// hang up, and the next deputy takes over what is proved to be a command of its own config. What is not, it kills.
/// When the service is stopped instead, systemd closes the terminals, and the commands get SIGHUP. Without systemd
/// nobody restarts a deputy: nothing is kept.
class Adoptions {
 public:
  /// Takes what was kept. Call it before files are opened; adopt() does the rest.
  Adoptions() : kept_(take_kept_descriptors()) {}

  struct Callbacks {
    std::function<void(const std::string& id, std::int32_t run_id)> adopted;  ///< before the supervisor's `started`
    std::function<void(const std::string& text)> log;
  };
  void adopt(const config::Config& config, process::Supervisor& supervisor, const Callbacks& callbacks);

  void started(const process::CommandState& state, std::int32_t run_id, int terminal);
  void ended(const std::string& id);

 private:
  std::vector<KeptDescriptor> kept_;
  std::map<std::string, std::string> names_;  // of the kept terminals, by command
};

}  // namespace curbstone::procman::deputy
