#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>

#include "procman/process/process_table.hpp"
#include "tests/paths.hpp"
#include "tests/system/run_program.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/bench/faults/watched_bus.hpp"
#include "tools/bench/programs/service_manager.hpp"

namespace curbstone::system_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

bool lives(int pid) {
  const auto process = procman::process::read_process(pid);
  return process && !process->zombie;
}

/// A deputy as systemd runs it: killed, it is started again, and the terminals of its commands were kept.
class DeputyAdoption : public ::testing::Test {
 protected:
  void start(const std::string& text) { start(text, manager_); }
  void start(const std::string& text, bench::programs::ServiceManager& manager) {
    write_file(folder_ / "test.cfg", text);
    deputy_ = manager.start(
        test::program_path("curbstone-deputy") + " --start-all --config " + (folder_ / "test.cfg").string(),
        folder_ / "output");
  }
  void kill_deputy() {
    const int infos = bus_.infos;
    deputy_->send_signal(SIGKILL);
    ASSERT_EQ(deputy_->wait(10), 128 + SIGKILL);
    infos_ = infos;
  }
  bool is_back() {
    return bus_.wait_until([&] { return bus_.infos > infos_ + 1; }, 10);
  }
  /// With all of `ids` running, whose terminals are kept.
  bool runs(const std::vector<std::string>& ids) {
    return bus_.wait_until(
        [&] {
          return manager_.kept() == ids.size() &&
                 std::all_of(ids.begin(), ids.end(), [&](const std::string& id) { return bus_.pid(id) > 0; });
        },
        10);
  }
  void wait(double seconds) {
    bus_.wait_until([] { return false; }, seconds);
  }

  test::TemporaryFolder folder_;
  bench::faults::WatchedBus bus_;
  bench::programs::ServiceManager manager_;
  std::unique_ptr<bench::programs::BackgroundProgram> deputy_;
  int infos_ = 0;
};

constexpr const char* kTalker = R"(
cmd "talker" {{ exec = "sh -c 'trap \"echo bye; exit 0\" INT; while :; do echo {}; sleep 0.1; done'"; deputy = "d"; auto_respawn = "true"; }}
)";

TEST_F(DeputyAdoption, WhatRunsRunsOnAndIsHeardWatchedAndStopped) {
  start(fmt::format(fmt::runtime(kTalker), "here"));
  ASSERT_TRUE(runs({"talker"})) << deputy_->output();
  const int first = bus_.pid("talker");
  kill_deputy();
  EXPECT_TRUE(lives(first));
  start(fmt::format(fmt::runtime(kTalker), "here"));
  ASSERT_TRUE(is_back()) << deputy_->output();
  EXPECT_EQ(bus_.pid("talker"), first) << deputy_->output();
  EXPECT_THAT(deputy_->output(), HasSubstr("talker runs on, started by an earlier deputy, pid"));
  bus_.output.clear();
  EXPECT_TRUE(bus_.wait_until([&] { return bus_.output["talker"].find("here") != std::string::npos; }, 5));

  kill(first, SIGKILL);
  ASSERT_TRUE(bus_.wait_until([&] { return bus_.pid("talker") > 0 && bus_.pid("talker") != first; }, 5))
      << "it is seen to end, and started again: " << deputy_->output();
  EXPECT_THAT(deputy_->output(), HasSubstr("talker ended: unknown exit status after"));
  ASSERT_TRUE(runs({"talker"}));
  const int second = bus_.pid("talker");
  kill_deputy();
  start(fmt::format(fmt::runtime(kTalker), "here"));
  ASSERT_TRUE(is_back());
  EXPECT_EQ(bus_.pid("talker"), second);
  deputy_->send_signal(SIGTERM);
  EXPECT_EQ(deputy_->wait(10), 0);
  EXPECT_FALSE(lives(second));
  EXPECT_THAT(deputy_->output(), HasSubstr("talker: bye")) << "it was asked, not killed";
  EXPECT_EQ(manager_.kept(), 0U);
}

TEST_F(DeputyAdoption, WhatTheConfigNoLongerHasSoIsKilledBeforeItsSuccessorStarts) {
  start(fmt::format(fmt::runtime(kTalker), "old"));
  ASSERT_TRUE(runs({"talker"})) << deputy_->output();
  const int first = bus_.pid("talker");
  kill_deputy();
  start(fmt::format(fmt::runtime(kTalker), "new"));
  ASSERT_TRUE(is_back()) << deputy_->output();
  EXPECT_FALSE(lives(first));
  EXPECT_NE(bus_.pid("talker"), first);
  EXPECT_THAT(deputy_->output(), HasSubstr(" of an earlier deputy, no command of this one: killed"));
}

TEST_F(DeputyAdoption, AnotherProcessUnderTheOldNumberIsNotTaken) {
  start(fmt::format(fmt::runtime(kTalker), "a"));
  ASSERT_TRUE(runs({"talker"})) << deputy_->output();
  const int first = bus_.pid("talker");
  kill_deputy();
  kill(first, SIGKILL);
  ASSERT_TRUE(bus_.wait_until([&] { return !lives(first); }, 5));
  start(fmt::format(fmt::runtime(kTalker), "a"));
  ASSERT_TRUE(is_back()) << deputy_->output();
  EXPECT_NE(bus_.pid("talker"), first);
  EXPECT_THAT(deputy_->output(), Not(HasSubstr("runs on")));
  EXPECT_TRUE(runs({"talker"})) << "only the terminal of what runs is kept";
}

TEST_F(DeputyAdoption, WhatACommandLeftBehindMeanwhileGoes) {
  start(R"(cmd "a" { exec = "sh -c 'trap \"\" HUP; setsid -f sleep 987; exec sleep 1000'"; deputy = "d"; })");
  ASSERT_TRUE(runs({"a"})) << deputy_->output();
  wait(0.5);
  const auto orphan = [] { return run_program("pgrep -fx 'sleep 987'").out; };
  ASSERT_NE(orphan(), "");
  const int first = bus_.pid("a");
  kill_deputy();
  kill(first, SIGKILL);
  start(R"(cmd "a" { exec = "sleep 1001"; deputy = "d"; })");
  ASSERT_TRUE(is_back()) << deputy_->output();
  EXPECT_EQ(orphan(), "") << deputy_->output();
}

TEST_F(DeputyAdoption, WhatAnotherServiceLeftIsNotTouched) {
  start(fmt::format(fmt::runtime(kTalker), "here"));
  ASSERT_TRUE(runs({"talker"})) << deputy_->output();
  const int first = bus_.pid("talker");
  kill_deputy();
  bench::programs::ServiceManager another;
  start(R"(cmd "a" { exec = "sleep 1002"; deputy = "d"; })", another);
  ASSERT_TRUE(is_back()) << deputy_->output();
  EXPECT_TRUE(lives(first)) << deputy_->output();
}

TEST_F(DeputyAdoption, StoppedForGoodNothingRunsOn) {
  start(fmt::format(fmt::runtime(kTalker), "here"));
  ASSERT_TRUE(runs({"talker"})) << deputy_->output();
  const int first = bus_.pid("talker");
  kill_deputy();
  EXPECT_TRUE(lives(first));
  manager_.close_all();
  EXPECT_TRUE(bus_.wait_until([&] { return !lives(first); }, 5)) << "its terminal hangs up";
}

}  // namespace
}  // namespace curbstone::system_test
