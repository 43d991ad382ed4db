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

/// How far an order has come.
enum class Progress { kUnderWay, kDone, kFailed };

/// What is known of one command.
struct Known {
  std::string deputy;
  procman_lcm::cmd_status_t status;
  int restarts = 0;              ///< new processes under the same command since this sheriff began
  std::int64_t heard_at = 0;     ///< us, of this process's last SERVICE_STATUS; 0: none
  std::int64_t reported_at = 0;  ///< us, of its deputy's last report
  std::vector<std::string> faults;

  /// Has this process said last that nothing is wrong?
  [[nodiscard]] bool ready() const { return status.pid != 0 && heard_at != 0 && faults.empty(); }
};

/// What deputies run, and what is wanted of it. Pure: messages and time (us since the Unix epoch) come in, orders go
/// out. An order names every command of its deputy, because a deputy removes what an order leaves out. It is made of
/// that deputy's report of the same moment: what nobody asked to change is ordered to stay as reported, so a sheriff
/// that has just come, or a deputy that has just been started again, changes nothing. The wire format and the run ids
/// are procman's (github.com/ashuang/procman).
class Sheriff {
 public:
  /// `begun`: us since the Unix epoch, when it came.
  explicit Sheriff(std::string id, std::int64_t begun = 0) : id_(std::move(id)), begun_(begun) {}

  /// A report older than 30 s comes from a log that is being played, and is left out.
  void on(const procman_lcm::deputy_info_t& info, std::int64_t now);
  void on(const service_status_t& status, std::int64_t now);
  /// Somebody's orders or claim.
  void on(const procman_lcm::orders_t& orders, std::int64_t now);

  /// Ids that a name stands for: a command, a group with its subgroups, or "everything".
  [[nodiscard]] std::vector<std::string> resolve(const std::string& name) const;
  /// No effect on a command that runs.
  void start(const std::string& id);
  void stop(const std::string& id);
  void restart(const std::string& id);
  /// By the reports of its deputy: one that is dead has done nothing.
  [[nodiscard]] Progress progress(const std::string& id) const;

  /// The orders for one deputy; nothing if nothing was asked of its commands. To be sent right after its report.
  [[nodiscard]] std::optional<procman_lcm::orders_t> orders(const std::string& deputy, std::int64_t now) const;

  /// Says to other sheriffs that this one is going to give orders: orders for no deputy, with the time at which this
  /// sheriff came (an addition to procman; deputies pay no attention). Of two that claim, the later one gives way.
  [[nodiscard]] procman_lcm::orders_t claim() const;

  /// By id.
  [[nodiscard]] const std::map<std::string, Known>& commands() const { return commands_; }
  /// What no command says of itself, a line each: the deputies' own faults (a command that hangs, or whose
  /// configuration is wrong), and how many commands two deputies run under one name.
  [[nodiscard]] std::vector<std::string> notes(std::int64_t now) const;
  /// Another sheriff that has given orders, or came earlier and will, in its own words; empty if none.
  [[nodiscard]] const std::string& other() const { return other_; }

 private:
  struct Wish {
    std::int32_t runid = 0;
    bool run = true;
    std::int32_t pid = 0;    // that the last report gave
    std::int64_t since = 0;  // us, since when it has had this pid in the run that was asked for
  };
  void wish_run(const std::string& id);

  struct Said {
    std::vector<std::string> faults;
    std::int64_t at = 0;  // us
  };

  std::string id_;
  std::int64_t begun_;
  std::string other_;
  std::map<std::string, Known> commands_;
  std::map<std::string, Said> deputies_;  // by service: "deputy:ID"
  std::map<std::pair<std::string, std::string>, std::map<std::string, std::int64_t>>
      twice_;  // by two deputies: commands of both, and when they were seen last, us
  std::map<std::string, Wish> wishes_;
};

/// The state in words: "running", "stopped", "failed: exit status 3", "failed: Segmentation fault".
[[nodiscard]] std::string describe(const procman_lcm::cmd_status_t& status);

}  // namespace curbstone::procman::sheriff
