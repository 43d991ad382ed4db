#pragma once

#include <cstdint>
#include <curbstone/service_status_t.hpp>
#include <map>
#include <optional>
#include <procman_lcm/cmd_status_t.hpp>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <string>
#include <utility>
#include <vector>

namespace curbstone::procman::sheriff {

/// Progress of an order.
enum class Progress { kUnderWay, kDone, kFailed };

/// State of one command as reported.
struct CommandInfo {
  std::string deputy;
  procman_lcm::cmd_status_t status;
  int restarts = 0;              ///< new processes of the command since this sheriff started
  std::int64_t heard_at = 0;     ///< us, of this process's latest SERVICE_STATUS; 0: none
  std::int64_t reported_at = 0;  ///< us, of its deputy's latest report
  std::vector<std::string> faults;
  bool is_settled = false;  ///< it has run long enough to name what it misses: SilenceTimer::kNamed

  /// Whether this process's latest status has no faults, and is not of its first seconds.
  [[nodiscard]] bool ready() const { return status.pid != 0 && heard_at != 0 && is_settled && faults.empty(); }
};

/// State of all deputies, and the orders to them. Pure: messages and time (us since the Unix epoch) are arguments,
/// orders are results. An order names every command of its deputy, because a deputy removes commands that an order
/// leaves out. It is made from that deputy's latest report: commands that nobody asked to change are ordered to stay as
/// reported, so a sheriff that has just started, or a deputy that was restarted, changes nothing. The wire format and
/// the run ids are procman's (github.com/ashuang/procman).
class Sheriff {
 public:
  /// `begun`: us since the Unix epoch, start of this sheriff.
  explicit Sheriff(std::string id, std::int64_t begun = 0) : id_(std::move(id)), begun_(begun) {}

  /// A report older than 30 s comes from a log that is being played, and is ignored.
  void on(const procman_lcm::deputy_info_t& info, std::int64_t now);
  void on(const service_status_t& status, std::int64_t now);
  /// Orders or a claim of any sheriff.
  void on(const procman_lcm::orders_t& orders, std::int64_t now);

  /// Ids of the commands that a name denotes: a command, a group with its subgroups, or "everything".
  [[nodiscard]] std::vector<std::string> resolve(const std::string& name) const;
  /// No effect on a command that is running.
  void start(const std::string& id);
  void stop(const std::string& id);
  void restart(const std::string& id);
  /// From the reports of its deputy: without a report there is no progress.
  [[nodiscard]] Progress progress(const std::string& id) const;

  /// The orders for one deputy; nothing if no change of its commands was requested. Send them right after its report.
  [[nodiscard]] std::optional<procman_lcm::orders_t> orders(const std::string& deputy, std::int64_t now) const;

  /// Announces to other sheriffs that this one is about to give orders: orders for no deputy, with this sheriff's start
  /// time (an addition to procman; deputies ignore it). Of two sheriffs that claim, the later one gives way.
  [[nodiscard]] procman_lcm::orders_t claim() const;

  /// By id.
  [[nodiscard]] const std::map<std::string, CommandInfo>& commands() const { return commands_; }
  /// Faults that no command reports itself, one line each: the deputies' own faults (a command that hangs, or whose
  /// configuration is wrong), and the number of commands that two deputies run under the same ids.
  [[nodiscard]] std::vector<std::string> notes(std::int64_t now) const;
  /// Name of another sheriff that has given orders, or has claimed with an earlier start; empty if none.
  [[nodiscard]] const std::string& other() const { return other_; }

 private:
  struct Request {
    std::int32_t runid = 0;
    bool run = true;
    std::int32_t pid = 0;    // of the latest report
    std::int64_t since = 0;  // us, since when it has had this pid in the requested run
  };
  void request_run(const std::string& id);

  struct DeputyFaults {
    std::vector<std::string> faults;
    std::int64_t at = 0;  // us
  };

  std::string id_;
  std::int64_t begun_;
  std::string other_;
  std::map<std::string, CommandInfo> commands_;
  std::map<std::string, DeputyFaults> deputies_;  // by service: "deputy:ID"
  std::map<std::pair<std::string, std::string>, std::map<std::string, std::int64_t>>
      duplicates_;  // by two deputies: commands of both, and when they were seen last, us
  std::map<std::string, Request> requests_;
};

/// The state in words: "running", "stopped", "failed: exit status 3", "failed: Segmentation fault".
[[nodiscard]] std::string describe(const procman_lcm::cmd_status_t& status);

}  // namespace curbstone::procman::sheriff
