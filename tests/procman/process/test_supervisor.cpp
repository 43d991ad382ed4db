#include "procman/process/supervisor.hpp"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "tests/procman/process/supervised.hpp"

namespace curbstone::procman::process {
namespace {

using ::testing::HasSubstr;

bool is_alive(pid_t pid) {
  return kill(pid, 0) == 0;
}

TEST(Supervisor, KeepsTheRawWaitStatus) {
  Supervised s;
  s.start(s.add("exit 3", "sh -c 'exit 3'"));
  s.start(s.add("segv", "sh -c 'ulimit -c 0; kill -SEGV $$'"));
  s.start(s.add("none", "/no/such/program"));
  s.start(s.add("ok", "true"));
  s.start(s.add("unbalanced", "sh -c 'x"));
  ASSERT_TRUE(s.run_until([&] { return s.ends.size() == 5; }));
  EXPECT_EQ(s.supervisor.find("exit 3")->exit_status, 0x300);
  EXPECT_EQ(s.supervisor.find("segv")->exit_status & 0x7f, SIGSEGV);
  EXPECT_EQ(s.supervisor.find("none")->exit_status, 0x7f00);
  EXPECT_THAT(s.output["none"], HasSubstr("/no/such/program: No such file or directory"));
  EXPECT_EQ(s.supervisor.find("ok")->exit_status, 0);
  EXPECT_EQ(s.supervisor.find("unbalanced")->exit_status, 0x7f00);
}

TEST(Supervisor, GivesATerminalASessionAndACleanSignalState) {
  Supervised s;
  s.start(s.add("terminal", "sh -c 'test -t 0 && test -t 1 && test -t 2 && echo yes'"));
  s.start(s.add("files", "ls /proc/self/fd"));
  s.start(s.add("signals", "grep -E 'SigBlk|SigIgn' /proc/self/status"));
  s.start(s.add("session", "sh -c 'ps -o sid=,pgid=,tpgid= -p $$'"));
  const std::string pid = std::to_string(s.supervisor.find("session")->pid);
  ASSERT_TRUE(s.run_until([&] { return s.ends.size() == 4; }));
  EXPECT_EQ(s.output["terminal"], "yes\r\n");
  EXPECT_THAT(s.output["files"], ::testing::MatchesRegex("0[ \t\r\n]+1[ \t\r\n]+2[ \t\r\n]+3[ \t\r\n]*"))
      << "the fourth is that of ls: nothing of ours leaks";
  EXPECT_THAT(s.output["session"], ::testing::MatchesRegex(" *" + pid + " +" + pid + " +" + pid + "\r\n"));
  EXPECT_THAT(s.output["signals"], HasSubstr("SigBlk:\t0000000000000000"));
  const std::size_t ignored = s.output["signals"].find("SigIgn:\t");
  ASSERT_NE(ignored, std::string::npos);
  EXPECT_EQ(std::stoull(s.output["signals"].substr(ignored + 8, 16), nullptr, 16) & 0x7fffffffU, 0U)
      << "32 and 33 are glibc's";
}

TEST(Supervisor, AssignmentsReachTheEnvironment) {
  Supervised s;
  s.start(s.add("a", "GREETING='hello you' sh -c 'echo \"[$GREETING]\"'"));
  ASSERT_TRUE(s.run_until_ended("a"));
  EXPECT_EQ(s.output["a"], "[hello you]\r\n");
}

TEST(Supervisor, ABurstBeforeTheEndArrivesComplete) {
  Supervised s;
  s.start(s.add("a", "sh -c 'seq 1 150000; echo the end'"));
  ASSERT_TRUE(s.run_until_ended("a"));
  std::string expected;
  for (int i = 1; i <= 150000; ++i) expected += std::to_string(i) + "\r\n";
  EXPECT_EQ(s.output["a"].size(), expected.size() + 9) << "1.2 MB";
  EXPECT_EQ(s.output["a"], expected + "the end\r\n");
}

TEST(Supervisor, StopsWithTheSignalOfTheCommand) {
  Supervised s;
  config::Command command = s.add("a", "sh -c 'trap \"echo bye; exit 0\" TERM; echo up; while :; do sleep 0.05; done'");
  command.stop_signal = SIGTERM;
  s.start(command);
  ASSERT_TRUE(s.run_until([&] { return s.output["a"] == "up\r\n"; }));
  s.supervisor.stop("a");
  ASSERT_TRUE(s.run_until_ended("a"));
  EXPECT_THAT(s.output["a"], ::testing::EndsWith("bye\r\n"));
  EXPECT_EQ(s.ends.at(0).status, 0);
  EXPECT_FALSE(s.ends.at(0).killed);
}

TEST(Supervisor, KillsWhatIgnoresTheSignalByItsOwnTimer) {
  Supervised s;
  config::Command command = s.add("a", "sh -c 'trap \"\" INT; echo up; while :; do sleep 0.05; done'");
  command.stop_time_allowed = 0.3;
  s.start(command);
  ASSERT_TRUE(s.run_until([&] { return s.output["a"] == "up\r\n"; }));
  const std::int64_t begin = steady_clock();
  s.supervisor.stop("a");
  ASSERT_TRUE(s.run_until_ended("a"));
  EXPECT_GE(steady_clock() - begin, 300'000);
  EXPECT_EQ(s.ends.at(0).status, SIGKILL);
  EXPECT_TRUE(s.ends.at(0).killed);
  EXPECT_FALSE(s.ends.at(0).hung);
}

/// Of a process: how willingly the kernel ends it when memory runs out, -1000 (never) to 1000.
int oom_score(pid_t pid) {
  int score = 1001;
  std::ifstream("/proc/" + std::to_string(pid) + "/oom_score_adj") >> score;
  return score;
}

TEST(Supervisor, WhatIsStartedIsNotSparedAsTheDeputyIsWhenMemoryRunsOut) {
  const int before = oom_score(getpid());
  std::ofstream("/proc/self/oom_score_adj") << -500;
  if (oom_score(getpid()) != -500)
    GTEST_SKIP() << "without CAP_SYS_RESOURCE nobody may spare himself; scripts/check vm tries it";
  Supervised s;
  s.start(s.add("a", "sleep 1000"));
  ASSERT_TRUE(s.run_until([&] { return s.supervisor.find("a")->pid > 0; }));
  EXPECT_EQ(oom_score(s.supervisor.find("a")->pid), 0);
  std::ofstream("/proc/self/oom_score_adj") << before;
}

TEST(Supervisor, WhatHangsIsKilledAtOnceAndStartedAgain) {
  Supervised s;
  config::Command command = s.add("a", "sh -c 'trap \"echo bye; exit 0\" INT; echo up; while :; do sleep 0.05; done'");
  command.stop_time_allowed = 1000;
  s.start(command);
  ASSERT_TRUE(s.run_until([&] { return s.output["a"] == "up\r\n"; }));
  s.supervisor.replace("a");
  ASSERT_TRUE(s.run_until([&] { return s.starts["a"].size() == 2; }, 60)) << "though it need not respawn by itself";
  EXPECT_TRUE(s.ends.at(0).killed);
  EXPECT_TRUE(s.ends.at(0).hung) << "it was not asked to stop";
  EXPECT_EQ(s.ends.at(0).status, SIGKILL) << "one that wakes up must not end the drive, as a stop signal makes it do";
  EXPECT_EQ(s.output["a"].find("bye"), std::string::npos);
}

TEST(Supervisor, ACommandWithAHeartbeatThatRefusesItsConfigurationIsNotStartedAgain) {
  Supervised s;
  config::Command command = s.add("a", "sh -c 'exit 2'");
  command.auto_respawn = true;
  command.heartbeat = 3;
  s.start(command);
  ASSERT_TRUE(s.run_until_ended("a"));
  EXPECT_TRUE(s.supervisor.find("a")->refused);
  EXPECT_EQ(s.starts["a"].size(), 1U);
  s.supervisor.start("a");
  ASSERT_TRUE(s.run_until_ended("a"));
  EXPECT_EQ(s.starts["a"].size(), 2U) << "by an order it is";
}

TEST(Supervisor, ACommandOfAnotherKindMayEndWithTheSameStatus) {
  Supervised s;
  config::Command command = s.add("a", "sh -c 'exit 2'");
  command.auto_respawn = true;
  s.start(command);
  ASSERT_TRUE(s.run_until([&] { return s.starts["a"].size() == 2; }));
  EXPECT_FALSE(s.supervisor.find("a")->refused);
  s.supervisor.stop("a");
}

TEST(Supervisor, GrandchildrenEndWithTheCommandEvenInSessionsOfTheirOwn) {
  Supervised s;
  config::Command command =
      s.add("a", "sh -c 'sleep 7351 & echo $!; setsid sleep 7352 & sleep 0.2; setsid -f sleep 7353; echo up; wait'");
  command.stop_time_allowed = 1;
  s.start(command);
  ASSERT_TRUE(s.run_until([&] { return s.output["a"].ends_with("up\r\n"); }));
  const pid_t grandchild = std::stoi(s.output["a"]);
  EXPECT_TRUE(is_alive(grandchild));
  // Numbers of this test's own: others run at the same time and sleep too.
  const auto sleepers = [] { return system("pgrep -f '^sleep 735[123]$' > /dev/null") == 0; };
  s.supervisor.stop("a");
  ASSERT_TRUE(s.run_until_ended("a"));
  EXPECT_FALSE(is_alive(grandchild));
  EXPECT_FALSE(sleepers());
}

TEST(Supervisor, WhatACrashLeavesBehindIsStoppedBeforeTheNextLife) {
  Supervised s;
  config::Command command = s.add("a", "sh -c 'setsid -f sleep 1003; sleep 0.1; exit 1'");
  command.auto_respawn = true;
  s.start(command);
  ASSERT_TRUE(s.run_until([&] { return s.ends.size() == 2; }));
  s.supervisor.stop("a");
  ASSERT_TRUE(s.run_until_ended("a"));
  EXPECT_NE(system("pgrep -f '^sleep 1003$' > /dev/null"), 0);
}

TEST(Supervisor, RespawnsWithGrowingGapsUntilItIsStopped) {
  Supervised s;
  config::Command command = s.add("a", "sh -c 'exit 1'");
  command.auto_respawn = true;
  s.start(command);
  ASSERT_TRUE(s.run_until([&] { return s.starts["a"].size() == 6; }));
  const auto& starts = s.starts["a"];
  for (std::size_t i = 1; i < starts.size(); ++i) {
    const std::int64_t gap = starts[i] - s.ends[i - 1].at;
    const std::int64_t expected = 10'000 << i;  // 20, 40, 80 ms: never sooner; how much later is the machine's affair
    EXPECT_GE(gap, expected - 1000) << i;
  }
  s.supervisor.stop("a");
  ASSERT_TRUE(s.run_until_ended("a"));
  const std::size_t lives = s.starts["a"].size();
  s.run_for(0.8);
  EXPECT_EQ(s.starts["a"].size(), lives) << "a pending respawn is cancelled";
}

TEST(Supervisor, AOneShotIsNotRunAgain) {
  Supervised s;
  s.start(s.add("a", "true"));
  ASSERT_TRUE(s.run_until_ended("a"));
  s.run_for(0.1);
  EXPECT_EQ(s.starts["a"].size(), 1U);
}

TEST(Supervisor, RestartStartsOnceTheOldLifeHasEnded) {
  Supervised s;
  s.start(s.add("a", "sleep 1000"));
  const pid_t first = s.supervisor.find("a")->pid;
  s.supervisor.restart("a");
  ASSERT_TRUE(s.run_until([&] { return s.starts["a"].size() == 2; }));
  EXPECT_FALSE(is_alive(first));
  EXPECT_NE(s.supervisor.find("a")->pid, 0);
}

TEST(Supervisor, RemovedWhileRunningIsForgottenWhenItHasEnded) {
  Supervised s;
  s.start(s.add("a", "sleep 1000"));
  s.supervisor.remove("a");
  EXPECT_NE(s.supervisor.find("a"), nullptr);
  ASSERT_TRUE(s.run_until([&] { return s.supervisor.find("a") == nullptr; }));
  s.add("b", "true");
  s.supervisor.remove("b");
  EXPECT_EQ(s.supervisor.find("b"), nullptr);
}

TEST(Supervisor, LeavesNothingBehindWhenItGoes) {
  pid_t pid = 0;
  {
    Supervised s;
    s.start(s.add("a", "sh -c 'trap \"\" INT TERM HUP; sleep 1000'"));
    pid = s.supervisor.find("a")->pid;
    ASSERT_TRUE(is_alive(pid));
  }
  EXPECT_FALSE(is_alive(pid));
}

TEST(Supervisor, AFloodOfOneDoesNotStarveTheOther) {
  Supervised s;
  s.start(s.add("flood", "yes"));
  s.on_output = [&](const std::string& id, std::string_view) {
    if (id == "flood") s.output[id].clear();
  };
  s.start(s.add("a", "sh -c 'for i in 1 2 3 4 5; do echo $i; sleep 0.02; done'"));
  ASSERT_TRUE(s.run_until_ended("a"));
  EXPECT_EQ(s.output["a"], "1\r\n2\r\n3\r\n4\r\n5\r\n");
}

}  // namespace
}  // namespace curbstone::procman::process
