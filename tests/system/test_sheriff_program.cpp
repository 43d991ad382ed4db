#include <gmock/gmock.h>
#include <signal.h>

#include <chrono>
#include <memory>
#include <thread>

#include "tests/system/run_program.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::system_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A deputy with two commands that run and one that fails.
class SheriffProgram : public ::testing::Test {
 protected:
  SheriffProgram() {
    write_file(folder_ / "test.cfg", R"(
group "g" {
  cmd "a" { exec = "sleep 1000"; deputy = "d"; auto_respawn = "true"; }
  cmd "b" { exec = "sh -c 'while :; do echo tick; sleep 0.1; done'"; deputy = "d"; }
}
cmd "c" { exec = "sh -c 'while :; do echo c: tock; sleep 0.1; done'"; deputy = "d"; }
cmd "never" { exec = "false"; deputy = "d"; auto_respawn = "true"; }
cmd "wrong" { exec = "sh -c 'exit 3'"; deputy = "d"; }
script "go" { start group "g" wait "running"; }
)");
    start_deputy();
  }
  void start_deputy() {
    deputy_ = std::make_unique<BackgroundProgram>("curbstone-deputy --config " + (folder_ / "test.cfg").string(),
                                                  folder_ / "output");
  }
  static ProgramResult sheriff(const std::string& arguments) {
    return run_program("curbstone-sheriff " + arguments, 60);
  }
  /// The deputy answers.
  static bool wait_for_deputy() {
    for (int i = 0; i < 20; ++i) {
      if (sheriff("status").exit_status == 0) return true;
    }
    return false;
  }
  test::TemporaryFolder folder_;
  std::unique_ptr<BackgroundProgram> deputy_;
};

TEST_F(SheriffProgram, StartsRestartsAndStopsByCommandAndGroup) {
  ASSERT_TRUE(wait_for_deputy());
  const auto started = sheriff("start g");
  EXPECT_EQ(started.exit_status, 0) << started.err;
  EXPECT_EQ(started.out, "a: running\nb: running\n");
  const auto restarted = sheriff("restart a --wait 40");
  EXPECT_EQ(restarted.exit_status, 0) << restarted.err;
  const auto stopped = sheriff("stop a");
  EXPECT_EQ(stopped.exit_status, 0) << stopped.err;
  EXPECT_EQ(stopped.out, "a: stopped\n");
  EXPECT_THAT(sheriff("status").out, ::testing::ContainsRegex("b +running")) << "b was not asked for";
}

TEST_F(SheriffProgram, SaysWhatFailedAndWhatIsUnknown) {
  ASSERT_TRUE(wait_for_deputy());
  const auto failed = sheriff("start wrong");
  EXPECT_EQ(failed.exit_status, 1);
  EXPECT_EQ(failed.out, "wrong: failed: exit status 3\n");
  EXPECT_EQ(sheriff("start nobody").exit_status, 2);
  EXPECT_EQ(sheriff("start a --observe").exit_status, 2);
}

TEST_F(SheriffProgram, RunsAScript) {
  ASSERT_TRUE(wait_for_deputy());
  const auto run = sheriff("run go --config " + (folder_ / "test.cfg").string());
  EXPECT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, ::testing::ContainsRegex("a +running"));
}

TEST_F(SheriffProgram, TailNamesEachLineOnce) {
  ASSERT_TRUE(wait_for_deputy());
  ASSERT_EQ(sheriff("start g c").exit_status, 0);
  BackgroundProgram tail("curbstone-sheriff tail", folder_ / "tail");
  const auto shows = [&](const char* line) { return tail.output().find(line) != std::string::npos; };
  for (int i = 0; i < 200 && !(shows("b: tick\n") && shows("c: tock\n")); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_THAT(tail.output(), AllOf(HasSubstr("b: tick\n"), HasSubstr("c: tock\n"), Not(HasSubstr("c: c: "))));
}

TEST_F(SheriffProgram, ASecondOneThatCommandsNamesTheFirstAndDoesNothing) {
  ASSERT_TRUE(wait_for_deputy());
  // It respawns without end and so is never done: the first goes on giving orders.
  BackgroundProgram first("curbstone-sheriff start never --wait 100", folder_ / "first");
  bool commands = false;
  for (int i = 0; i < 20 && !commands; ++i)
    commands = sheriff("status").out.find("failed: exit status 1") != std::string::npos;
  ASSERT_TRUE(commands) << first.output();
  const auto second = sheriff("stop everything");
  EXPECT_EQ(second.exit_status, 4) << second.out;
  EXPECT_THAT(second.err, HasSubstr("another sheriff gives orders: "));
}

TEST_F(SheriffProgram, OfTwoThatBeginTogetherOneGivesOrders) {
  ASSERT_TRUE(wait_for_deputy());
  BackgroundProgram first("curbstone-sheriff start a", folder_ / "first");
  const auto second = sheriff("start b");
  ASSERT_GE(first.wait(60), 0);
  EXPECT_THAT((std::vector{first.wait(0), second.exit_status}), ::testing::UnorderedElementsAre(0, 4))
      << first.output() << second.out << second.err;
}

TEST_F(SheriffProgram, ADeputyThatWasKilledIsCommandedAgainWhenItIsBack) {
  ASSERT_TRUE(wait_for_deputy());
  ASSERT_EQ(sheriff("start g").exit_status, 0);
  deputy_->send_signal(SIGKILL);
  deputy_->wait(10);
  const auto nobody = sheriff("start a");
  EXPECT_EQ(nobody.exit_status, 3);
  EXPECT_THAT(nobody.err, HasSubstr("no deputy"));
  start_deputy();
  ASSERT_TRUE(wait_for_deputy());
  EXPECT_EQ(sheriff("start g").exit_status, 0);
}

}  // namespace
}  // namespace curbstone::system_test
