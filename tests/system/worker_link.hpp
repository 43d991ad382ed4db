#pragma once

#include <chrono>
#include <curbstone/service_status_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/local_bus.hpp"
#include "tests/system/run_program.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::system_test {

/// A bus of its own (UDP multicast, a port) with voting workers on it, and a relay between it and the test's bus that
/// loses a share of the messages in both directions.
class WorkerLink {
 public:
  /// What the workers say goes to `local`.
  WorkerLink(int port, double loss, unsigned seed, LocalBus& local, const test::TemporaryFolder& folder);

  /// `prefix`: before the command.
  void start(const std::string& worker, const std::string& prefix = "");
  /// kill -9: nothing more from it.
  void kill(const std::string& worker);
  /// Fails the test when a worker has ended by itself. False then.
  [[nodiscard]] bool all_live();

  [[nodiscard]] const std::string& url() const { return url_; }

  /// Towards the workers.
  void send(const std::string& channel, const void* data, int size);
  /// Takes what has come from the workers, waiting at most `timeout` for the first message.
  void receive(std::chrono::milliseconds timeout) { bus_.handle(timeout); }

  /// The heartbeats of a link's workers, for the workers on other links.
  std::function<void(const tile_index_t&)> heartbeat;
  std::map<std::string, service_status_t> statuses;  ///< by worker
  int lost = 0;

 private:
  [[nodiscard]] bool loses();

  std::string url_;
  LcmBus bus_;
  double loss_;
  std::mt19937 random_;
  const test::TemporaryFolder& folder_;
  std::map<std::string, std::unique_ptr<BackgroundProgram>> workers_;
  std::set<std::string> killed_;
};

}  // namespace curbstone::system_test
