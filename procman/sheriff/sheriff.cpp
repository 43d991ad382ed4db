#include "procman/sheriff/sheriff.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <limits>
#include <tuple>

#include "common/time/silence_timer.hpp"

namespace curbstone::procman::sheriff {

namespace {

constexpr std::int64_t kMaxInfoAge = 30'000'000;   // us
constexpr std::int64_t kMaxOrdersAge = 5'000'000;  // us
constexpr std::int64_t kSilence = 5'000'000;       // us after which a report no longer describes the present
constexpr std::int64_t kMinLife = 1'000'000;       // us that a process must live before its start counts as done

/// Age of a message, us; `utime` may have any value.
std::int64_t age_of_message(std::int64_t utime, std::int64_t now) {
  return now - std::max<std::int64_t>(utime, 0);
}

std::int32_t next_run(std::int32_t runid) {
  return runid <= 0 || runid == std::numeric_limits<std::int32_t>::max() ? 1 : runid + 1;
}

/// Exit status 0, or the signal of an intentional stop.
bool ended_well(int status) {
  if (!WIFSIGNALED(status)) return WEXITSTATUS(status) == 0;
  return WTERMSIG(status) == SIGINT || WTERMSIG(status) == SIGTERM;
}

}  // namespace

void Sheriff::on(const procman_lcm::deputy_info_t& info, std::int64_t now) {
  if (age_of_message(info.utime, now) > kMaxInfoAge) return;
  std::erase_if(commands_, [&](const auto& entry) {
    return entry.second.deputy == info.deputy_id &&
           std::none_of(info.cmds.begin(), info.cmds.end(),
                        [&](const auto& status) { return status.cmd.command_id == entry.first; });
  });
  for (auto& [deputies, commands] : duplicates_)
    std::erase_if(commands, [&](const auto& seen) { return now - seen.second >= kSilence; });
  std::erase_if(duplicates_, [](const auto& pair) { return pair.second.empty(); });
  for (const auto& status : info.cmds) {
    CommandInfo& known = commands_[status.cmd.command_id];
    const std::int32_t before = known.status.pid;
    const bool is_anothers = !known.deputy.empty() && known.deputy != info.deputy_id;
    if (is_anothers && now - known.reported_at < kSilence)
      duplicates_[std::minmax(known.deputy, info.deputy_id)][status.cmd.command_id] = now;
    if (!known.deputy.empty() && !is_anothers && status.pid != 0 && status.pid != before) ++known.restarts;
    if (status.pid != before) {
      known.heard_at = 0;
      known.faults.clear();
    }
    known.deputy = info.deputy_id;
    known.status = status;
    known.reported_at = now;
    const auto request = requests_.find(status.cmd.command_id);
    if (request == requests_.end()) continue;
    if (request->second.since == 0 || request->second.pid != status.pid || status.actual_runid != request->second.runid)
      request->second.since = now;
    request->second.pid = status.pid;
  }
}

void Sheriff::on(const service_status_t& status, std::int64_t now) {
  if (status.service.starts_with("deputy:")) {
    std::erase_if(deputies_, [&](const auto& report) { return now - report.second.at >= kSilence; });
    deputies_[status.service] = {status.fault, now};
  }
  const auto found = commands_.find(status.service);
  if (found == commands_.end()) return;
  found->second.heard_at = now;
  found->second.faults = status.fault;
  found->second.is_settled = status.uptime >= SilenceTimer::kNamed;
}

std::vector<std::string> Sheriff::notes(std::int64_t now) const {
  std::vector<std::string> notes;
  for (const auto& [deputies, commands] : duplicates_) {
    const auto count = std::ranges::count_if(commands, [&](const auto& seen) { return now - seen.second < kSilence; });
    if (count > 0)
      notes.push_back(fmt::format("deputies {} and {} both have {} of these commands: two stacks on one bus",
                                  deputies.first, deputies.second, count));
  }
  for (const auto& [deputy, report] : deputies_) {
    if (now - report.at >= kSilence) continue;
    for (const std::string& fault : report.faults) notes.push_back(fmt::format("{}: {}", deputy, fault));
  }
  return notes;
}

void Sheriff::on(const procman_lcm::orders_t& orders, std::int64_t now) {
  if (orders.sheriff_id == id_ || age_of_message(orders.utime, now) > kMaxOrdersAge) return;
  const bool is_claim = orders.deputy_id.empty();
  if (is_claim && std::tie(orders.utime, orders.sheriff_id) > std::tie(begun_, id_)) return;
  other_ = orders.sheriff_id;
}

procman_lcm::orders_t Sheriff::claim() const {
  procman_lcm::orders_t claim;
  claim.utime = begun_;
  claim.sheriff_id = id_;
  claim.ncmds = 0;
  return claim;
}

std::vector<std::string> Sheriff::resolve(const std::string& name) const {
  std::vector<std::string> ids;
  for (const auto& [id, known] : commands_) {
    const std::string& group = known.status.cmd.group;
    if (name == "everything" || id == name || group == name || group.starts_with(name + "/")) ids.push_back(id);
  }
  return ids;
}

void Sheriff::request_run(const std::string& id) {
  const auto found = commands_.find(id);
  if (found != commands_.end()) requests_[id] = {.runid = next_run(found->second.status.actual_runid)};
}

void Sheriff::start(const std::string& id) {
  const auto found = commands_.find(id);
  if (found == commands_.end()) return;
  if (found->second.status.pid == 0) return request_run(id);
  requests_[id] = {.runid = found->second.status.actual_runid};
}

void Sheriff::stop(const std::string& id) {
  const auto found = commands_.find(id);
  if (found != commands_.end()) requests_[id] = {.runid = found->second.status.actual_runid, .run = false};
}

void Sheriff::restart(const std::string& id) {
  request_run(id);
}

Progress Sheriff::progress(const std::string& id) const {
  const auto request = requests_.find(id);
  const auto found = commands_.find(id);
  if (request == requests_.end() || found == commands_.end()) return Progress::kFailed;
  const procman_lcm::cmd_status_t& status = found->second.status;
  if (request->second.since == 0) return Progress::kUnderWay;  // no report since the request
  if (!request->second.run) return status.pid == 0 ? Progress::kDone : Progress::kUnderWay;
  if (status.actual_runid != request->second.runid) return Progress::kUnderWay;
  const std::int64_t lived = found->second.reported_at - request->second.since;
  if (status.pid != 0) return lived >= kMinLife ? Progress::kDone : Progress::kUnderWay;
  if (status.cmd.auto_respawn != 0) return Progress::kUnderWay;
  return ended_well(status.exit_code) ? Progress::kDone : Progress::kFailed;
}

std::optional<procman_lcm::orders_t> Sheriff::orders(const std::string& deputy, std::int64_t now) const {
  procman_lcm::orders_t orders;
  orders.utime = now;
  orders.deputy_id = deputy;
  orders.sheriff_id = id_;
  bool asked = false;
  for (const auto& [id, known] : commands_) {
    if (known.deputy != deputy) continue;
    procman_lcm::cmd_desired_t order;
    order.cmd = known.status.cmd;
    order.desired_runid = known.status.actual_runid;
    order.force_quit = 0;
    if (const auto request = requests_.find(id); request != requests_.end()) {
      asked = true;
      order.desired_runid = request->second.runid;
      order.force_quit = request->second.run ? 0 : 1;
    }
    orders.cmds.push_back(std::move(order));
  }
  if (!asked) return std::nullopt;
  orders.ncmds = static_cast<std::int32_t>(orders.cmds.size());
  return orders;
}

std::string describe(const procman_lcm::cmd_status_t& status) {
  if (status.pid != 0) return "running";
  if (ended_well(status.exit_code)) return "stopped";
  if (WIFSIGNALED(status.exit_code)) return fmt::format("failed: {}", strsignal(WTERMSIG(status.exit_code)));
  return fmt::format("failed: exit status {}", WEXITSTATUS(status.exit_code));
}

}  // namespace curbstone::procman::sheriff
