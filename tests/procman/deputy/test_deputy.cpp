#include "procman/deputy/deputy.hpp"

#include <gmock/gmock.h>
#include <signal.h>

#include <procman_lcm/output_t.hpp>

#include "common/bus/local_bus.hpp"
#include "tests/procman/process/supervised.hpp"

namespace curbstone::procman::deputy {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A deputy on a local bus, and a sheriff made of bare messages.
class DeputyOnTheBus : public ::testing::Test {
 protected:
  void begin(std::optional<config::Config> allow_list = std::nullopt, std::int64_t window = 500'000) {
    deputy_.emplace(DeputyOptions{.id = "robot",
                                  .allow_list = std::move(allow_list),
                                  .allow_empty_orders = allow_empty_orders_,
                                  .discovery_window = window},
                    s_.supervisor, bus_);
    deputy_->connect(bus_);
    bus_.subscribe<procman_lcm::deputy_info_t>("PM_INFO", [this](const auto& info) { infos_.push_back(info); });
    bus_.subscribe<procman_lcm::discovery_t>("PM_DISCOVER", [this](const auto& m) { discoveries_.push_back(m); });
    bus_.subscribe<procman_lcm::output_t>("PM_OUTPUT", [this](const auto& message) {
      for (std::size_t i = 0; i < message.text.size(); ++i) text_[message.command_ids[i]] += message.text[i];
    });
    s_.on_output = [this](const std::string& id, std::string_view bytes) { deputy_->output(id, bytes); };
    s_.tick = [this] {
      deputy_->tick();
      bus_.dispatch();
    };
  }
  void begin_active(std::optional<config::Config> allow_list = std::nullopt) {
    begin(std::move(allow_list), 10'000);
    ASSERT_TRUE(s_.run_until([this] { return deputy_->active(); }));
  }

  static procman_lcm::cmd_desired_t order(const std::string& id, const std::string& exec, int runid,
                                          bool quit = false) {
    procman_lcm::cmd_desired_t order{};
    order.cmd.command_id = id;
    order.cmd.exec_str = exec;
    order.cmd.stop_signal = SIGINT;
    order.cmd.stop_time_allowed = 2;
    order.desired_runid = runid;
    order.force_quit = quit ? 1 : 0;
    return order;
  }
  void send(std::vector<procman_lcm::cmd_desired_t> cmds, const std::string& deputy = "robot", std::int64_t age = 0) {
    procman_lcm::orders_t orders;
    orders.utime = wall_clock() - age;
    orders.deputy_id = deputy;
    orders.sheriff_id = "test:1:1";
    orders.ncmds = static_cast<std::int32_t>(cmds.size());
    orders.cmds = std::move(cmds);
    bus_.publish("PM_ORDERS", orders);
    bus_.dispatch();
  }
  [[nodiscard]] pid_t pid(const std::string& id) const {
    const process::CommandState* state = s_.supervisor.find(id);
    return state == nullptr ? -1 : state->pid;
  }
  [[nodiscard]] int runid(const std::string& id) const {
    if (infos_.empty()) return -1;
    for (const auto& status : infos_.back().cmds) {
      if (status.cmd.command_id == id) return status.actual_runid;
    }
    return -1;
  }

  bool allow_empty_orders_ = false;
  process::Supervised s_;
  LocalBus bus_;
  std::optional<Deputy> deputy_;
  std::vector<procman_lcm::deputy_info_t> infos_;
  std::vector<procman_lcm::discovery_t> discoveries_;
  std::map<std::string, std::string> text_;
};

TEST_F(DeputyOnTheBus, DiscoversThreeTimesAndThenReports) {
  begin();
  ASSERT_TRUE(s_.run_until([this] { return !infos_.empty(); }));
  EXPECT_EQ(discoveries_.size(), 3U);
  EXPECT_EQ(discoveries_[0].transmitter_id, "robot");
  EXPECT_EQ(discoveries_[0].nonce, getpid());
  EXPECT_EQ(infos_[0].deputy_id, "robot");
  EXPECT_EQ(infos_[0].ncmds, 0);
  EXPECT_GT(infos_[0].phys_mem_total_bytes, 0);
  EXPECT_EQ(deputy_->conflict(), "");
}

TEST_F(DeputyOnTheBus, AnotherWithItsIdStartingOrRunningIsAConflict) {
  begin();
  procman_lcm::discovery_t other{wall_clock(), "robot", getpid() + 1};
  bus_.publish("PM_DISCOVER", other);
  bus_.dispatch();
  EXPECT_THAT(deputy_->conflict(), HasSubstr("is starting"));
}

TEST_F(DeputyOnTheBus, AnotherWithItsIdRunningIsAConflict) {
  begin();
  procman_lcm::deputy_info_t info{};
  info.utime = wall_clock();
  info.deputy_id = "somebody else";
  bus_.publish("PM_INFO", info);
  bus_.dispatch();
  EXPECT_EQ(deputy_->conflict(), "");
  info.deputy_id = "robot";
  bus_.publish("PM_INFO", info);
  bus_.dispatch();
  EXPECT_THAT(deputy_->conflict(), HasSubstr("is running"));
}

TEST_F(DeputyOnTheBus, APlayedLogIsNoConflict) {
  begin();
  procman_lcm::deputy_info_t info{};
  info.utime = wall_clock() - 6'000'000;
  info.deputy_id = "robot";
  bus_.publish("PM_INFO", info);
  bus_.publish("PM_DISCOVER", procman_lcm::discovery_t{wall_clock() - 6'000'000, "robot", getpid() + 1});
  bus_.dispatch();
  EXPECT_EQ(deputy_->conflict(), "");
}

TEST_F(DeputyOnTheBus, RunIdZeroRegistersAndOneStarts) {
  begin_active();
  send({order("a", "sleep 1000", 0)});
  EXPECT_EQ(pid("a"), 0);
  send({order("a", "sleep 1000", 1)});
  EXPECT_GT(pid("a"), 0);
  ASSERT_TRUE(s_.run_until([this] { return runid("a") == 1; }, 0.5)) << "a change is reported at once";
  EXPECT_EQ(infos_.back().cmds[0].pid, pid("a"));
}

TEST_F(DeputyOnTheBus, TheSameOrdersAgainDoNothing) {
  begin_active();
  send({order("a", "true", 1)});
  ASSERT_TRUE(s_.run_until_ended("a"));
  for (int i = 0; i < 3; ++i) send({order("a", "true", 1)});
  s_.run_for(0.05);
  EXPECT_EQ(s_.starts["a"].size(), 1U);
}

TEST_F(DeputyOnTheBus, ARaisedRunIdRestartsWithALaterOrder) {
  begin_active();
  send({order("a", "sleep 1000", 1)});
  const pid_t first = pid("a");
  send({order("a", "sleep 1000", 2)});
  ASSERT_TRUE(s_.run_until_ended("a"));
  EXPECT_EQ(s_.starts["a"].size(), 1U);
  send({order("a", "sleep 1000", 2)});
  EXPECT_GT(pid("a"), 0);
  EXPECT_NE(pid("a"), first);
}

TEST_F(DeputyOnTheBus, ForceQuitStopsAndEscalatesWithoutFurtherOrders) {
  begin_active();
  auto stubborn = order("a", "sh -c 'trap \"\" INT; echo up; while :; do sleep 0.02; done'", 1);
  stubborn.cmd.stop_time_allowed = 0.2F;
  send({stubborn});
  ASSERT_TRUE(s_.run_until([this] { return text_["a"] == "up\r\n"; }));
  stubborn.force_quit = 1;
  send({stubborn});
  ASSERT_TRUE(s_.run_until_ended("a"));
  EXPECT_EQ(s_.supervisor.find("a")->exit_status, SIGKILL);
}

TEST_F(DeputyOnTheBus, ForceQuitCancelsARespawn) {
  begin_active();
  auto crasher = order("a", "false", 1);
  crasher.cmd.auto_respawn = 1;
  send({crasher});
  ASSERT_TRUE(s_.run_until([this] { return s_.ends.size() == 4; }));
  EXPECT_EQ(runid("a"), 1) << "a respawn keeps the run id";
  crasher.force_quit = 1;
  send({crasher});
  ASSERT_TRUE(s_.run_until_ended("a"));
  const std::size_t lives = s_.starts["a"].size();
  s_.run_for(0.5);
  EXPECT_EQ(s_.starts["a"].size(), lives);
}

TEST_F(DeputyOnTheBus, LeavingACommandOutRemovesIt) {
  begin_active();
  send({order("a", "sleep 1000", 1), order("b", "sleep 1000", 0), order("c", "sleep 1000", 0)});
  send({order("c", "sleep 1000", 0)});
  EXPECT_EQ(pid("b"), -1);
  ASSERT_TRUE(s_.run_until([this] { return pid("a") == -1; }));
  EXPECT_EQ(pid("c"), 0);
}

TEST_F(DeputyOnTheBus, AnOrderThatNamesNoCommandStopsNothing) {
  begin_active();
  send({order("a", "sleep 1000", 1)});
  const pid_t first = pid("a");
  for (int i = 0; i < 10; ++i) send({});
  EXPECT_EQ(pid("a"), first);
  EXPECT_EQ(deputy_->counters()["refused.order"], 10);
  ASSERT_TRUE(s_.run_until([this] { return text_.contains(""); }));
  EXPECT_THAT(text_[""], HasSubstr("names no command"));
}

TEST_F(DeputyOnTheBus, AnOrderThatNamesNoCommandRemovesAllWhereThatIsAllowed) {
  allow_empty_orders_ = true;
  begin_active();
  send({order("a", "sleep 1000", 1), order("b", "sleep 1000", 0)});
  send({});
  EXPECT_EQ(pid("b"), -1);
  ASSERT_TRUE(s_.run_until([this] { return pid("a") == -1; }));
}

TEST_F(DeputyOnTheBus, CommandsOfTheAllowListAreNeitherRemovedNorChanged) {
  allow_empty_orders_ = true;
  begin_active(config::parse_config(
      "cmd \"a\" { exec = \"sleep 1000\"; deputy = \"robot\"; auto_respawn = \"true\"; stop_signal = 2; }", "x"));
  auto changed = order("a", "sleep 1000", 1);
  changed.cmd.stop_signal = SIGKILL;
  changed.cmd.auto_respawn = 0;
  changed.cmd.stop_time_allowed = 0;
  send({changed});
  const pid_t first = pid("a");
  EXPECT_GT(first, 0);
  const config::Command& command = s_.supervisor.find("a")->command;
  EXPECT_EQ(command.stop_signal, SIGINT);
  EXPECT_TRUE(command.auto_respawn);
  EXPECT_EQ(command.stop_time_allowed, config::kDefaultStopTimeAllowed);
  EXPECT_EQ(deputy_->counters()["refused.change"], 1);
  send({order("b", "sleep 1000", 1)});
  send({});
  EXPECT_EQ(pid("a"), first);
  EXPECT_EQ(deputy_->counters()["refused.removal"], 2);
  send({order("a", "sleep 1000", 1, true)});
  ASSERT_TRUE(s_.run_until_ended("a")) << "it can be stopped";
}

TEST_F(DeputyOnTheBus, AChangedExecTakesEffectAtTheNextStart) {
  begin_active();
  send({order("a", "sleep 1000", 1)});
  const pid_t first = pid("a");
  send({order("a", "echo other", 1)});
  EXPECT_EQ(pid("a"), first);
  send({order("a", "echo other", 1, true)});
  ASSERT_TRUE(s_.run_until_ended("a"));
  send({order("a", "echo other", 2)});
  ASSERT_TRUE(s_.run_until([this] { return text_["a"].ends_with("other\r\n"); }));
}

TEST_F(DeputyOnTheBus, OrdersThatAreStaleOrForOthersAreIgnored) {
  begin_active();
  send({order("a", "sleep 1000", 1)}, "somebody else");
  send({order("a", "sleep 1000", 1)}, "robot", 61'000'000);
  EXPECT_EQ(pid("a"), -1);
  ASSERT_TRUE(s_.run_until([this] { return text_.contains("a"); }));
  EXPECT_THAT(text_["a"], HasSubstr("orders ignored: they are 61 s old"));
  send({order("a", "sleep 1000", 1)}, "robot", -3600'000'000);
  EXPECT_GT(pid("a"), 0) << "orders from the future are accepted";
}

TEST_F(DeputyOnTheBus, AnyTimeInAMessageIsSurvived) {
  begin_active();
  for (const std::int64_t utime : {std::int64_t{INT64_MIN}, std::int64_t{-1}, std::int64_t{INT64_MAX}}) {
    procman_lcm::orders_t orders{};
    orders.utime = utime;
    orders.deputy_id = "robot";
    bus_.publish("PM_ORDERS", orders);
    bus_.publish("PM_DISCOVER", procman_lcm::discovery_t{utime, "robot", getpid() + 1});
    procman_lcm::deputy_info_t info{};
    info.utime = utime;
    info.deputy_id = "robot";
    bus_.publish("PM_INFO", info);
    bus_.dispatch();
  }
  EXPECT_EQ(deputy_->counters()["refused.stale"], 2);
}

TEST_F(DeputyOnTheBus, OnlyTheAllowListIsRun) {
  begin_active(config::parse_config("cmd \"a\" { exec = \"sleep 1000\"; deputy = \"robot\"; }", "x"));
  send({order("a", "rm -rf /nowhere", 1), order("b", "sleep 1000", 1)});
  EXPECT_EQ(pid("a"), -1);
  EXPECT_EQ(pid("b"), -1);
  EXPECT_EQ(deputy_->counters()["refused.order"], 2);
  send({order("a", "sleep 1000", 1)});
  EXPECT_GT(pid("a"), 0);
  ASSERT_TRUE(s_.run_until([this] { return text_.contains("b"); }));
  EXPECT_THAT(text_["b"], HasSubstr("order refused"));
}

TEST_F(DeputyOnTheBus, OrdersDuringShutdownAreIgnored) {
  begin_active();
  deputy_->begin_shutdown();
  send({order("a", "sleep 1000", 1)});
  EXPECT_EQ(pid("a"), -1);
}

TEST_F(DeputyOnTheBus, AnswersADiscoveryWithItsStateAndLetsASheriffCatchUp) {
  begin_active();
  ASSERT_TRUE(s_.run_until([this] { return !infos_.empty(); }));
  int arrived = 0;
  deputy_->on_sheriff_arrived = [&] { ++arrived; };
  const std::size_t before = infos_.size();
  bus_.publish("PM_DISCOVER", procman_lcm::discovery_t{wall_clock(), "sheriff", 0});
  ASSERT_TRUE(s_.run_until([&] { return infos_.size() > before; }, 0.5));
  EXPECT_EQ(arrived, 1);
}

TEST_F(DeputyOnTheBus, ReportsCommandsSortedWithUsageOfTheRunning) {
  begin_active();
  send({order("b", "sleep 1000", 1), order("c", "true", 0), order("a", "sh -c 'while :; do :; done'", 1)});
  ASSERT_TRUE(s_.run_until(
      [this] { return !infos_.empty() && infos_.back().ncmds == 3 && infos_.back().cmds[0].cpu_usage > 0; }));
  const auto& cmds = infos_.back().cmds;
  EXPECT_EQ(cmds[0].cmd.command_id, "a");
  EXPECT_EQ(cmds[1].cmd.command_id, "b");
  EXPECT_EQ(cmds[2].cmd.command_id, "c");
  EXPECT_GT(cmds[1].mem_rss_bytes, 0);
  EXPECT_EQ(cmds[2].pid, 0);
  EXPECT_EQ(cmds[2].mem_rss_bytes, 0);
  EXPECT_LE(cmds[0].cpu_usage, 1.0F);
}

TEST_F(DeputyOnTheBus, ManyCommandsOfStrangersAreBounded) {
  begin_active();
  std::vector<procman_lcm::cmd_desired_t> orders;
  for (int i = 0; i < 1000; ++i) orders.push_back(order("c" + std::to_string(i), "true", 0));
  send(orders);
  EXPECT_EQ(s_.supervisor.commands().size(), 300U);
}

}  // namespace
}  // namespace curbstone::procman::deputy
