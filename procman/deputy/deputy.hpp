#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <set>
#include <string>

#include "common/bus/bus.hpp"
#include "common/bus/counters.hpp"
#include "procman/output/output_queue.hpp"
#include "procman/process/supervisor.hpp"
#include "procman/process/usage_meter.hpp"

namespace curbstone::procman::deputy {

struct DeputyOptions {
  std::string id;
  /// Orders are accepted only for the commands of this config, with exactly its exec strings; how they are stopped and
  /// respawned is this config's too, and they are not removed. None: for any.
  std::optional<config::Config> allow_list;
  /// An order without any command removes all of them. Only where this is said: it is what a damaged one looks like.
  bool allow_empty_orders = false;
  std::int64_t discovery_window = 500'000;  ///< us in which somebody else may claim the id
};

/// A deputy as a sheriff sees it on the bus: discovery, PM_INFO, PM_ORDERS, PM_OUTPUT. Compatible with procman on the
/// wire (github.com/ashuang/procman). An order that cannot be carried out is counted, and refused in words once. One
/// thread calls everything.
class Deputy {
 public:
  Deputy(DeputyOptions options, process::Supervisor& supervisor, Publisher& bus);

  void connect(Subscriber& bus);
  /// Every 10 ms or so: discovery, PM_INFO at 1 Hz, pending PM_OUTPUT.
  void tick();

  /// True once nobody else has claimed our id for half a second.
  [[nodiscard]] bool active() const { return active_; }
  /// Who has claimed it, in words; empty when nobody has.
  [[nodiscard]] const std::string& conflict() const { return conflict_; }

  /// Starts a command without a sheriff's order.
  void start(const std::string& id);
  /// Orders are ignored from this call on.
  void begin_shutdown() { shutting_down_ = true; }

  /// What a command printed, to be sent as PM_OUTPUT. With an empty id it is text of the deputy itself.
  void output(const std::string& id, std::string_view bytes) { output_.add(id, bytes); }
  /// Sends PM_INFO with the next tick: something has changed.
  void changed() { info_due_ = 0; }
  /// Sends all that is pending, at the end.
  void flush();

  /// Called when a sheriff announces itself, so that the last lines can be output() again.
  std::function<void()> on_sheriff_arrived;

  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  void on(const procman_lcm::discovery_t& message);
  void on(const procman_lcm::deputy_info_t& message);
  void on(const procman_lcm::orders_t& message);
  void apply(const procman_lcm::cmd_desired_t& order);
  void remove_missing(const procman_lcm::orders_t& message);
  [[nodiscard]] const config::Command* own(const std::string& id) const;
  void refuse(const std::string& id, const std::string& why);
  void publish_discovery();
  void publish_info();

  DeputyOptions options_;
  process::Supervisor& supervisor_;
  Publisher& bus_;
  output::OutputQueue output_;
  process::UsageMeter meter_;
  Counters counters_;
  std::map<std::string, std::int32_t> runids_;
  std::set<std::string> refused_;  // said once
  std::string conflict_;
  bool active_ = false;
  bool shutting_down_ = false;
  std::int64_t begun_ = 0;          // us, steady
  std::int64_t discovery_due_ = 0;  // us, steady
  std::int64_t info_due_ = 0;
  std::int64_t output_due_ = 0;
};

}  // namespace curbstone::procman::deputy
