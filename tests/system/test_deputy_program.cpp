#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>

#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>

#include "common/time/clock.hpp"
#include "tests/system/run_program.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/bench/faults/watched_bus.hpp"

namespace curbstone::system_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

bool is_alive(int pid) {
  return pid > 0 && kill(pid, 0) == 0;
}

class DeputyProgram : public ::testing::Test {
 protected:
  std::string config(const std::string& text) {
    write_file(folder_ / "test.cfg", text);
    return folder_ / "test.cfg";
  }
  std::unique_ptr<BackgroundProgram> start(const std::string& options) {
    return std::make_unique<BackgroundProgram>("curbstone-deputy " + options, folder_ / "output");
  }
  bool wait_for_pid(const std::string& id) {
    return bus_.wait_until([&] { return bus_.pid(id) > 0; }, 10);
  }
  test::TemporaryFolder folder_;
  bench::faults::WatchedBus bus_;
};

constexpr const char* kPipeline = R"(
group "source" { cmd "source" { exec = "sh -c 'trap \"sleep 0.3; exit 0\" INT; while :; do sleep 0.05; done'"; deputy = "d"; } }
group "sink" { cmd "sink" { exec = "sh -c 'trap \"echo sink ends; exit 0\" INT; while :; do sleep 0.05; done'"; deputy = "d"; } }
)";

TEST_F(DeputyProgram, RunsAConfigAloneAndStopsItInTheOrderOfTheFile) {
  auto deputy = start("--config " + config(kPipeline) + " --start-all --log-dir " + (folder_ / "logs").string());
  ASSERT_TRUE(wait_for_pid("source") && wait_for_pid("sink")) << deputy->output();
  const int source = bus_.pid("source");
  const int sink = bus_.pid("sink");
  EXPECT_EQ(bus_.deputy.deputy_id, "d");
  bus_.wait_until([] { return false; }, 0.3);  // so that the traps are set
  deputy->send_signal(SIGINT);
  EXPECT_EQ(deputy->wait(10), 0);
  EXPECT_FALSE(is_alive(source));
  EXPECT_FALSE(is_alive(sink));
  const std::string said = deputy->output();
  EXPECT_LT(said.find("sink started"), said.find("source started")) << "sinks first";
  EXPECT_LT(said.find("source ended: exit status 0"), said.find("sink: sink ends")) << said;
  EXPECT_THAT(said, HasSubstr("sink ended: exit status 0"));
  EXPECT_THAT(read_file(folder_ / "logs/sink.log"),
              ::testing::ContainsRegex("Z sink ends\n20[-0-9:.T]+Z -- ended: exit status 0"));
}

TEST_F(DeputyProgram, BringsBackWhatIsKilled) {
  auto deputy =
      start("--config " + config("cmd \"a\" { exec = \"sleep 1000\"; deputy = \"d\"; auto_respawn = \"true\"; }") +
            " --start-all");
  ASSERT_TRUE(wait_for_pid("a")) << deputy->output();
  const int first = bus_.pid("a");
  kill(first, SIGKILL);
  ASSERT_TRUE(bus_.wait_until([&] { return bus_.pid("a") > 0 && bus_.pid("a") != first; }, 5));
  EXPECT_TRUE(bus_.wait_until([&] { return bus_.output["a"] == "Killed\n"; }, 2)) << bus_.output["a"];
}

TEST_F(DeputyProgram, ReplacesAServiceThatHangs) {
  auto deputy = start("--config " +
                      config("cmd \"ekf\" { exec = \"curbstone-ekf --set state_file=\"; deputy = \"d\"; "
                             "auto_respawn = \"true\"; heartbeat = \"3\"; }") +
                      " --start-all");
  ASSERT_TRUE(wait_for_pid("ekf")) << deputy->output();
  const int first = bus_.pid("ekf");
  ASSERT_TRUE(bus_.wait_until([&] { return bus_.status("ekf") != nullptr; }, 30));
  bus_.wait_until([] { return false; }, 6);
  EXPECT_EQ(bus_.pid("ekf"), first) << "it works: " << deputy->output();
  kill(first, SIGSTOP);
  ASSERT_TRUE(bus_.wait_until([&] { return bus_.pid("ekf") > 0 && bus_.pid("ekf") != first; }, 60)) << deputy->output();
  EXPECT_FALSE(is_alive(first));
  EXPECT_THAT(deputy->output(), HasSubstr("ekf has said nothing for 3 s: it hangs and is replaced"));
  EXPECT_TRUE(
      bus_.wait_until([&] { return deputy->output().find("it hung and is replaced") != std::string::npos; }, 20))
      << "not as one that would not stop: " << deputy->output();
  EXPECT_TRUE(bus_.wait_until([&] { return bus_.has_fault("deputy:d", "ekf was silent for 3 s"); }, 30));
}

TEST_F(DeputyProgram, DoesNotStartAgainWhoRefusesItsConfiguration) {
  write_file(folder_ / "ugv.yaml", "ekf:\n  no_such_key: 1\n");
  auto deputy = start("--config " +
                      config("cmd \"ekf\" { exec = \"curbstone-ekf --config " + (folder_ / "ugv.yaml").string() +
                             "\"; deputy = \"d\"; auto_respawn = \"true\"; heartbeat = \"3\"; }") +
                      " --start-all");
  ASSERT_TRUE(bus_.wait_until([&] { return bus_.has_fault("deputy:d", "ekf: wrong configuration"); }, 30))
      << deputy->output();
  bus_.wait_until([] { return false; }, 3);
  const std::string said = deputy->output();
  EXPECT_EQ(said.find("ekf started"), said.rfind("ekf started")) << said;
  EXPECT_THAT(said, HasSubstr("no_such_key"));
}

TEST_F(DeputyProgram, EndsWithTheCommandThatItIsToldToWaitForAndSaysWhetherItFailed) {
  const std::string text =
      "cmd \"a\" {{ exec = \"sh -c 'sleep 0.3; exit {}'\"; deputy = \"d\"; }}"
      "cmd \"b\" {{ exec = \"sleep 1000\"; deputy = \"d\"; }}";
  EXPECT_EQ(
      run_program("curbstone-deputy --start-all --exit-when a --config " + config(fmt::format(fmt::runtime(text), 0)))
          .exit_status,
      0);
  EXPECT_EQ(
      run_program("curbstone-deputy --start-all --exit-when a --config " + config(fmt::format(fmt::runtime(text), 5)))
          .exit_status,
      1);
}

TEST_F(DeputyProgram, SaysWhatTheDoctorFoundAndGoesOn) {
  setenv("CURBSTONE_CONFIG", "/nowhere/ugv.yaml", 1);
  auto deputy =
      start("--doctor --start-all --config " + config("cmd \"a\" { exec = \"sleep 1000\"; deputy = \"d\"; }"));
  ASSERT_TRUE(bus_.wait_until([&] { return bus_.has_fault("deputy:d", "doctor: "); }, 90)) << deputy->output();
  EXPECT_TRUE(bus_.has_fault("deputy:d", "/nowhere/ugv.yaml")) << deputy->output();
  const auto count = [&] {
    const std::string said = deputy->output(), finding = "doctor: config: /nowhere/ugv.yaml";
    return said.find(finding) == std::string::npos ? 0 : said.find(finding) == said.rfind(finding) ? 1 : 2;
  };
  EXPECT_TRUE(bus_.wait_until([&] { return count() > 0; }, 20)) << deputy->output();
  bus_.wait_until([] { return false; }, 3);
  EXPECT_EQ(count(), 1) << deputy->output();
  EXPECT_GT(bus_.pid("a"), 0);
  deputy->send_signal(SIGINT);
  EXPECT_EQ(deputy->wait(10), 0);
}

TEST_F(DeputyProgram, RunsAScript) {
  const auto result = run_program("curbstone-deputy --script go --exit-when b --config " + config(R"(
    script "go" { start cmd "a" wait "running"; wait cmd "a" status "stopped"; start cmd "b"; }
    cmd "a" { exec = "sh -c 'sleep 0.2; echo first'"; deputy = "d"; }
    cmd "b" { exec = "echo b: second"; deputy = "d"; })"));
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, Not(HasSubstr("b: b: "))) << "a service names itself";
  EXPECT_LT(result.out.find("a: first"), result.out.find("b: second")) << result.out;
}

TEST_F(DeputyProgram, AScriptGoesOnWhenAServiceHasSpoken) {
  auto deputy = start("--script go --config " + config(R"(
    script "go" { start cmd "ekf" wait "running"; start cmd "b"; }
    cmd "ekf" { exec = "sh -c 'sleep 1; exec curbstone-ekf --set state_file='"; deputy = "d"; heartbeat = "10"; }
    cmd "b" { exec = "sleep 1000"; deputy = "d"; })"));
  ASSERT_TRUE(bus_.wait_until([&] { return bus_.pid("b") > 0; }, 60)) << deputy->output();
  EXPECT_NE(bus_.status("ekf"), nullptr) << "what b says, ekf hears";
}

TEST_F(DeputyProgram, ASecondSignalKillsAtOnce) {
  auto deputy =
      start("--config " +
            config("cmd \"a\" { exec = \"sh -c 'trap \\\"\\\" INT TERM; echo up; while :; do sleep 0.05; done'\"; "
                   "deputy = \"d\"; stop_time_allowed = 60; }") +
            " --start-all");
  ASSERT_TRUE(bus_.wait_until([&] { return bus_.output["a"] == "up\r\n"; }, 10)) << deputy->output();
  const int pid = bus_.pid("a");
  deputy->send_signal(SIGTERM);
  EXPECT_EQ(deputy->wait(0.5), -1);
  deputy->send_signal(SIGTERM);
  EXPECT_EQ(deputy->wait(10), 0);
  EXPECT_FALSE(is_alive(pid));
  EXPECT_THAT(deputy->output(), HasSubstr("a ended: Killed"));
}

TEST_F(DeputyProgram, ItsChildrenGoWithItEvenWhenItIsKilled) {
  auto deputy = start("--config " + config("cmd \"a\" { exec = \"sleep 1000\"; deputy = \"d\"; }") + " --start-all");
  ASSERT_TRUE(wait_for_pid("a"));
  const int pid = bus_.pid("a");
  deputy->send_signal(SIGKILL);
  deputy->wait(5);
  EXPECT_TRUE(bus_.wait_until([&] { return !is_alive(pid); }, 5)) << "the terminal hangs up";
}

TEST_F(DeputyProgram, ASecondOneWithTheSameIdGivesUp) {
  const std::string file = config("cmd \"a\" { exec = \"sleep 1000\"; deputy = \"d\"; }");
  auto deputy = start("--config " + file);
  ASSERT_TRUE(bus_.wait_until([&] { return bus_.infos > 0; }, 10));
  const auto second = run_program("curbstone-deputy --config " + file);
  EXPECT_EQ(second.exit_status, 2);
  EXPECT_THAT(second.err, HasSubstr("another deputy \"d\" is running"));
  EXPECT_TRUE(deputy->running());
}

TEST_F(DeputyProgram, TakesOrdersFromASheriffForItsOwnCommandsOnly) {
  auto deputy = start("--config " + config("cmd \"a\" { exec = \"sleep 1000\"; deputy = \"d\"; }"));
  ASSERT_TRUE(bus_.wait_until([&] { return bus_.infos > 0; }, 10));
  EXPECT_EQ(bus_.pid("a"), 0);
  procman_lcm::orders_t orders;
  orders.utime = wall_clock();
  orders.deputy_id = "d";
  orders.sheriff_id = "test";
  orders.ncmds = 2;
  orders.cmds.resize(2);
  orders.cmds[0].cmd.command_id = "a";
  orders.cmds[0].cmd.exec_str = "sleep 1000";
  orders.cmds[0].desired_runid = 1;
  orders.cmds[1].cmd.command_id = "b";
  orders.cmds[1].cmd.exec_str = "sleep 1001";
  orders.cmds[1].desired_runid = 1;
  bus_.bus.publish("PM_ORDERS", orders);
  ASSERT_TRUE(wait_for_pid("a")) << deputy->output();
  EXPECT_EQ(bus_.pid("b"), -1);
  EXPECT_TRUE(bus_.wait_until([&] { return bus_.output["b"].find("order refused") != std::string::npos; }, 2));
}

TEST_F(DeputyProgram, ASheriffThatComesLateSeesTheLastLines) {
  auto deputy =
      start("--config " + config("cmd \"a\" { exec = \"sh -c 'echo early bird; sleep 1000'\"; deputy = \"d\"; }") +
            " --start-all");
  ASSERT_TRUE(bus_.wait_until([&] { return bus_.output["a"] == "early bird\r\n"; }, 10));
  bus_.output.clear();
  bus_.bus.publish("PM_DISCOVER", procman_lcm::discovery_t{wall_clock(), "sheriff", 0});
  EXPECT_TRUE(bus_.wait_until([&] { return bus_.output["a"] == "early bird\r\n"; }, 2)) << bus_.output["a"];
}

TEST_F(DeputyProgram, SaysWhatIsWrongWithItsConfigAndOptions) {
  const auto refused = [&](const std::string& options, const std::string& says) {
    const auto result = run_program("curbstone-deputy " + options);
    EXPECT_EQ(result.exit_status, 2) << options;
    EXPECT_THAT(result.err, HasSubstr(says)) << options;
  };
  refused("", "--config FILE.cfg");
  refused("--config /nowhere.cfg", "/nowhere.cfg: cannot read it");
  refused("--config " + config("cmd \"a\" { exec = \"x\" }"), "test.cfg:1:22: expected ';'");
  const std::string good = config("cmd \"a\" { exec = \"x\"; deputy = \"d\"; }");
  refused("--config " + good + " --id other", "only for: d");
  refused("--config " + good + " --script go", "no script \"go\"");
  refused("--config " + good + " --exit-when b", "no such command");
  const auto bus = run_program("curbstone-deputy --config " + good + " --lcm-url nonsense://x");
  EXPECT_EQ(bus.exit_status, 1);
  EXPECT_THAT(bus.err, HasSubstr("nonsense://x"));
  const auto logs = run_program("curbstone-deputy --config " + good + " --log-dir /proc/nowhere");
  EXPECT_EQ(logs.exit_status, 1);
  EXPECT_THAT(logs.err, HasSubstr("/proc/nowhere"));
}

}  // namespace
}  // namespace curbstone::system_test
