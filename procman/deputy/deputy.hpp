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
  /// If set, orders are accepted only for the commands of this config, with exactly its exec strings. Stop and respawn
  /// settings are those of this config too, and its commands cannot be removed. If not set, orders are accepted for any
  /// command.
  std::optional<config::Config> allow_list;
  /// Accept an order without any command, which removes all of them. Off by default: a damaged order looks the same.
  bool allow_empty_orders = false;
  std::int64_t discovery_window = 500'000;  ///< us in which another deputy may claim the id
};

/// The bus protocol of a deputy, as a sheriff sees it: discovery, PM_INFO, PM_ORDERS, PM_OUTPUT. Compatible with
/// procman on the wire (github.com/ashuang/procman). An order that cannot be carried out is counted, and its refusal is
/// reported once. All calls from one thread.
class Deputy {
 public:
  Deputy(DeputyOptions options, process::Supervisor& supervisor, Publisher& bus);

  void connect(Subscriber& bus);
  /// Call it about every 10 ms: discovery, PM_INFO at 1 Hz, pending PM_OUTPUT.
  void tick();

  /// True once no other deputy has claimed this id for half a second.
  [[nodiscard]] bool active() const { return active_; }
  /// The deputy that has claimed this id, in words; empty if there is none.
  [[nodiscard]] const std::string& conflict() const { return conflict_; }

  /// Starts a command without a sheriff's order.
  void start(const std::string& id);
  /// An earlier deputy started the command, as this run.
  void adopted(const std::string& id, std::int32_t run_id) { runids_[id] = run_id; }
  [[nodiscard]] std::int32_t run_id(const std::string& id) const;
  /// Orders are ignored from this call on.
  void begin_shutdown() { shutting_down_ = true; }

  /// Queues a command's output, to be sent as PM_OUTPUT. With an empty id it is text of the deputy itself.
  void output(const std::string& id, std::string_view bytes) { output_.add(id, bytes); }
  /// Requests PM_INFO with the next tick, after a change.
  void changed() { info_due_ = 0; }
  /// Sends everything that is pending, at the end.
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
  std::set<std::string> refused_;  // reported once
  std::string conflict_;
  bool active_ = false;
  bool shutting_down_ = false;
  std::int64_t begun_ = 0;          // us, steady
  std::int64_t discovery_due_ = 0;  // us, steady
  std::int64_t info_due_ = 0;
  std::int64_t output_due_ = 0;
};

}  // namespace curbstone::procman::deputy
