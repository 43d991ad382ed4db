#include "procman/deputy/deputy.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <procman_lcm/output_t.hpp>

#include "common/time/clock.hpp"
#include "procman/deputy/orders.hpp"

namespace curbstone::procman::deputy {

namespace {
constexpr std::int64_t kDiscoveryPeriod = 200'000;
constexpr std::int64_t kInfoPeriod = 1'000'000;
constexpr std::int64_t kOutputPeriod = 10'000;  // one message at a time: no bursts
constexpr std::size_t kMaxCommands = 300;       // of foreign orders; bounds PM_INFO
constexpr std::size_t kMaxRefusedRemembered = 1000;
constexpr std::int64_t kPlayed = 5'000'000;  // us: an older message comes from a log that is being played
/// Age of a message, us; `utime` may have any value.
std::int64_t age_of(std::int64_t utime) {
  return wall_clock() - std::max<std::int64_t>(utime, 0);
}

}  // namespace

Deputy::Deputy(DeputyOptions options, process::Supervisor& supervisor, Publisher& bus)
    : options_(std::move(options)),
      supervisor_(supervisor),
      bus_(bus),
      output_(options_.id),
      begun_(steady_clock()),
      discovery_due_(begun_) {}

void Deputy::connect(Subscriber& bus) {
  bus.subscribe<procman_lcm::discovery_t>("PM_DISCOVER", [this](const auto& message) { on(message); });
  bus.subscribe<procman_lcm::deputy_info_t>("PM_INFO", [this](const auto& message) { on(message); });
  bus.subscribe<procman_lcm::orders_t>("PM_ORDERS", [this](const auto& message) { on(message); });
}

void Deputy::tick() {
  const std::int64_t now = steady_clock();
  if (!active_) {
    if (!conflict_.empty()) return;
    if (now - begun_ >= options_.discovery_window) {
      active_ = true;
    } else if (now >= discovery_due_) {
      discovery_due_ += kDiscoveryPeriod;
      publish_discovery();
    }
  }
  if (active_ && now >= info_due_) {
    info_due_ = now + kInfoPeriod;
    publish_info();
  }
  if (active_ && now >= output_due_ && !output_.empty()) {
    output_due_ = now + kOutputPeriod;
    if (const auto message = output_.take(wall_clock())) bus_.publish("PM_OUTPUT", *message);
  }
}

void Deputy::flush() {
  if (!active_) return;
  publish_info();
  for (int i = 0; i < 20 && !output_.empty(); ++i) {
    if (const auto message = output_.take(wall_clock())) bus_.publish("PM_OUTPUT", *message);
    usleep(kOutputPeriod / 2);
  }
}

void Deputy::start(const std::string& id) {
  if (runids_[id] == 0) runids_[id] = 1;
  supervisor_.start(id);
}

std::int32_t Deputy::run_id(const std::string& id) const {
  const auto it = runids_.find(id);
  return it == runids_.end() ? 0 : it->second;
}

void Deputy::on(const procman_lcm::discovery_t& message) {
  const bool ours = message.transmitter_id == options_.id && message.nonce == getpid();
  if (ours || age_of(message.utime) > kPlayed) return;
  if (active_) {
    changed();
    if (message.nonce == 0 && on_sheriff_arrived) on_sheriff_arrived();
  } else if (message.transmitter_id == options_.id) {
    conflict_ = fmt::format("another deputy \"{}\" is starting (its pid is {})", options_.id, message.nonce);
  }
}

void Deputy::on(const procman_lcm::deputy_info_t& message) {
  if (active_ || message.deputy_id != options_.id || age_of(message.utime) > kPlayed) return;
  conflict_ = fmt::format("another deputy \"{}\" is running", options_.id);
}

void Deputy::on(const procman_lcm::orders_t& message) {
  if (!active_ || shutting_down_ || message.deputy_id != options_.id) return;
  const std::int64_t age = age_of(message.utime);
  if (age > kStaleAfter) {
    counters_.add("refused.stale");
    for (const auto& order : message.cmds) {
      output(order.cmd.command_id,
             fmt::format("orders ignored: they are {:.0f} s old (clocks of sheriff and deputy differ?)\n",
                         static_cast<double>(age) * 1e-6));
    }
    return;
  }
  if (message.cmds.empty() && !options_.allow_empty_orders)
    return refuse("", "it names no command, which would stop all of them (--allow-empty-orders)");
  counters_.add("orders");
  for (const auto& order : message.cmds) apply(order);
  remove_missing(message);
}

void Deputy::apply(const procman_lcm::cmd_desired_t& order) {
  auto command = command_from_wire(order.cmd, options_.id);
  if (!command) return refuse(order.cmd.command_id, "its id or exec is empty or too long");
  if (options_.allow_list) {
    const config::Command* const known = own(command->id);
    if (known == nullptr || known->exec != command->exec)
      return refuse(command->id, "it is not in the deputy's own config with this exec");
    command->heartbeat = known->heartbeat;  // not on the wire
    if (*known != *command) counters_.add("refused.change");
    command = *known;
  }
  const process::CommandState* state = supervisor_.find(command->id);
  if (state == nullptr && supervisor_.commands().size() >= kMaxCommands)
    return refuse(command->id, "too many commands");
  if (state == nullptr || state->command != *command) {
    supervisor_.set(*command);
    changed();
    state = supervisor_.find(command->id);
  }
  std::int32_t& runid = runids_[command->id];
  supervisor_.set_wanted(command->id, order.force_quit == 0);
  switch (decide(state->pid != 0, runid, order.desired_runid, order.force_quit != 0)) {
    case OrderStep::kStart:
      runid = order.desired_runid;
      supervisor_.start(command->id);
      changed();
      break;
    case OrderStep::kStop:
      if (!state->stopping) changed();
      supervisor_.stop(command->id);
      break;
    case OrderStep::kTakeRunId:
      if (runid != order.desired_runid) changed();
      runid = order.desired_runid;
      break;
    case OrderStep::kNothing:
      break;
  }
}

void Deputy::remove_missing(const procman_lcm::orders_t& message) {
  std::set<std::string> ordered;
  for (const auto& order : message.cmds) ordered.insert(order.cmd.command_id);
  std::vector<std::string> missing;
  for (const process::CommandState* state : supervisor_.commands()) {
    if (ordered.contains(state->command.id)) continue;
    if (own(state->command.id) != nullptr)
      counters_.add("refused.removal");
    else
      missing.push_back(state->command.id);
  }
  for (const std::string& id : missing) {
    runids_.erase(id);
    supervisor_.remove(id);
    changed();
  }
}

const config::Command* Deputy::own(const std::string& id) const {
  return options_.allow_list ? options_.allow_list->find_command(id) : nullptr;
}

void Deputy::refuse(const std::string& id, const std::string& why) {
  counters_.add("refused.order");
  if (refused_.size() >= kMaxRefusedRemembered || !refused_.insert(id).second) return;
  output(id, fmt::format("order refused: {}\n", why));
}

void Deputy::publish_discovery() {
  procman_lcm::discovery_t message;
  message.utime = wall_clock();
  message.transmitter_id = options_.id;
  message.nonce = getpid();
  bus_.publish("PM_DISCOVER", message);
}

void Deputy::publish_info() {
  procman_lcm::deputy_info_t info{};
  info.utime = wall_clock();
  info.deputy_id = options_.id;
  meter_.sample(info);
  for (const process::CommandState* state : supervisor_.commands()) {
    procman_lcm::cmd_status_t status{};
    status.cmd = command_to_wire(state->command);
    status.pid = state->pid;
    status.actual_runid = run_id(state->command.id);
    status.exit_code = state->exit_status;
    meter_.measure(state->pid, status);
    info.cmds.push_back(std::move(status));
  }
  info.ncmds = static_cast<std::int32_t>(info.cmds.size());
  bus_.publish("PM_INFO", info);
}

}  // namespace curbstone::procman::deputy
