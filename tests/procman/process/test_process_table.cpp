#include "procman/process/process_table.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace curbstone::procman::process {
namespace {

TEST(ProcessTable, NamesWithBlanksAndBracketsDoNotConfuseIt) {
  const auto info = parse_process_stat(
      "4242 (a ) b (c) S 17 4242 4242 34816 4242 4194560 100 0 0 0 250 50 0 0 20 0 1 0 12345 1000000 25 "
      "18446744073709551615");
  ASSERT_TRUE(info);
  EXPECT_EQ(info->pid, 4242);
  EXPECT_EQ(info->parent, 17);
  EXPECT_EQ(info->session, 4242);
  EXPECT_EQ(info->terminal, 34816);
  EXPECT_FALSE(info->zombie);
  EXPECT_EQ(info->cpu_ticks, 300);
  EXPECT_EQ(info->start_ticks, 12345);
  EXPECT_EQ(info->memory_virtual, 1000000);
  EXPECT_EQ(info->memory_resident, 25 * sysconf(_SC_PAGESIZE));
}

TEST(ProcessTable, RefusesWhatIsCutShort) {
  const std::string line = "42 (x) S 1 42 42 0 0 0 0 0 0 0 1 2 0 0 20 0 1 0 5 100 7";
  ASSERT_TRUE(parse_process_stat(line));
  for (std::size_t size = 0; size + 1 < line.size(); ++size) EXPECT_FALSE(parse_process_stat(line.substr(0, size)));
}

TEST(ProcessTable, FindsThisProcess) {
  const auto self = read_process(getpid());
  ASSERT_TRUE(self);
  EXPECT_EQ(self->parent, getppid());
  EXPECT_GT(self->memory_resident, 0);
  EXPECT_FALSE(read_process(0));
}

TEST(ProcessTable, IsReadWhileProcessesEnd) {
  const pid_t parent = fork();
  if (parent == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (;;) {
      const pid_t child = fork();
      if (child == 0) _exit(0);
      waitpid(child, nullptr, 0);
    }
  }
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(read_process_table().empty());
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
}

TEST(ProcessTable, AFamilyIsTheLeadersSessionAndAllDescendantsInAnyOrder) {
  const std::vector<ProcessInfo> table = {
      {.pid = 30, .parent = 20, .session = 30},  // grandchild in a session of its own, before its parent
      {.pid = 20, .parent = 10, .session = 10},  //
      {.pid = 10, .parent = 1, .session = 10},   // the leader
      {.pid = 40, .parent = 1, .session = 10},   // an orphan of the session
      {.pid = 50, .parent = 10, .session = 10, .zombie = true},  //
      {.pid = 60, .parent = 1, .session = 60},                   // a stranger
  };
  EXPECT_EQ(find_family(table, 10, "no-such-mark"), (std::vector<pid_t>{30, 20, 10, 40}));
}

TEST(ProcessTable, TheMachineHasMemoryAndHasWorked) {
  const MachineInfo machine = read_machine();
  EXPECT_GT(machine.memory_total, machine.memory_free);
  EXPECT_GT(machine.cpu_ticks_total, machine.cpu_ticks_idle);
}

}  // namespace
}  // namespace curbstone::procman::process
