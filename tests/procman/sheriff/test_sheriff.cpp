#include "procman/sheriff/sheriff.hpp"

#include <gmock/gmock.h>

#include "procman/sheriff/status_table.hpp"

namespace curbstone::procman::sheriff {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::int64_t kNow = 1'700'000'000'000'000;

procman_lcm::cmd_status_t command(const std::string& id, int pid, int runid, int exit_code = 0) {
  procman_lcm::cmd_status_t status{};
  status.cmd.command_id = id;
  status.cmd.exec_str = "run " + id;
  status.cmd.group = "top/" + id;
  status.cmd.stop_signal = 2;
  status.pid = pid;
  status.actual_runid = runid;
  status.exit_code = exit_code;
  return status;
}

procman_lcm::deputy_info_t report(std::vector<procman_lcm::cmd_status_t> cmds, const std::string& deputy = "d") {
  procman_lcm::deputy_info_t info{};
  info.utime = kNow;
  info.deputy_id = deputy;
  info.ncmds = static_cast<std::int32_t>(cmds.size());
  info.cmds = std::move(cmds);
  return info;
}

/// As it is printed.
std::string table_of(const Sheriff& sheriff, std::int64_t now) {
  std::string text;
  for (const std::string& line : status_table(sheriff.commands(), now)) text += line + "\n";
  return text;
}

class SheriffTest : public ::testing::Test {
 protected:
  void receive(std::vector<procman_lcm::cmd_status_t> cmds, std::int64_t after = 0) {
    sheriff_.on(report(std::move(cmds)), kNow + after);
  }
  Sheriff sheriff_{"host:1:1"};
};

TEST_F(SheriffTest, GivesNoOrdersBeforeSomethingIsAsked) {
  receive({command("a", 10, 4)});
  EXPECT_FALSE(sheriff_.orders("d", kNow));
}

TEST_F(SheriffTest, OrdersEverythingElseToStayAsItIs) {
  receive({command("a", 10, 4), command("b", 0, 7), command("c", 0, 0)});
  sheriff_.start("c");
  const auto orders = sheriff_.orders("d", kNow);
  ASSERT_TRUE(orders);
  EXPECT_EQ(orders->sheriff_id, "host:1:1");
  ASSERT_EQ(orders->ncmds, 3) << "what is left out would be removed";
  EXPECT_EQ(orders->cmds[0].desired_runid, 4);
  EXPECT_EQ(orders->cmds[0].force_quit, 0);
  EXPECT_EQ(orders->cmds[1].desired_runid, 7);
  EXPECT_EQ(orders->cmds[2].desired_runid, 1);
  EXPECT_EQ(orders->cmds[2].cmd.exec_str, "run c");
}

TEST_F(SheriffTest, FollowsADeputyThatWasStartedAgain) {
  receive({command("a", 10, 4), command("b", 0, 0)});
  sheriff_.start("b");
  receive({command("a", 20, 1), command("b", 0, 0)});
  EXPECT_EQ(sheriff_.orders("d", kNow)->cmds[0].desired_runid, 1) << "4 would stop a";
}

TEST_F(SheriffTest, ForgetsWhatADeputyNoLongerReports) {
  receive({command("a", 10, 4), command("b", 0, 0)});
  sheriff_.on(report({command("x", 1, 1)}, "other"), kNow);
  receive({command("b", 0, 0)});
  EXPECT_THAT(sheriff_.resolve("everything"), ElementsAre("b", "x"));
}

TEST_F(SheriffTest, NamesAreCommandsAndGroupsWithTheirSubgroups) {
  receive({command("a", 0, 0), command("b", 0, 0)});
  EXPECT_THAT(sheriff_.resolve("a"), ElementsAre("a"));
  EXPECT_THAT(sheriff_.resolve("top/b"), ElementsAre("b"));
  EXPECT_THAT(sheriff_.resolve("top"), ElementsAre("a", "b"));
  EXPECT_THAT(sheriff_.resolve("to"), ElementsAre());
}

TEST_F(SheriffTest, ARestartIsDoneWhenTheNewRunHasLivedForASecond) {
  receive({command("a", 10, 4)});
  sheriff_.restart("a");
  EXPECT_EQ(sheriff_.orders("d", kNow)->cmds[0].desired_runid, 5);
  receive({command("a", 0, 4)});
  EXPECT_EQ(sheriff_.progress("a"), Progress::kUnderWay) << "the old run has ended";
  receive({command("a", 11, 5)}, 6'000'000);
  EXPECT_EQ(sheriff_.progress("a"), Progress::kUnderWay);
  receive({command("a", 11, 5)}, 6'900'000);
  EXPECT_EQ(sheriff_.progress("a"), Progress::kUnderWay);
  receive({command("a", 11, 5)}, 7'000'000);
  EXPECT_EQ(sheriff_.progress("a"), Progress::kDone);
  EXPECT_EQ(sheriff_.commands().at("a").restarts, 1);
}

TEST_F(SheriffTest, ADeputyThatDiedHasDoneNothing) {
  receive({command("a", 10, 4)});
  sheriff_.restart("a");
  receive({command("a", 11, 5)}, 1'000'000);
  sheriff_.on(report({command("x", 1, 1)}, "other"), kNow + 60'000'000);
  EXPECT_EQ(sheriff_.progress("a"), Progress::kUnderWay) << "nobody has said that it lived on";
}

TEST_F(SheriffTest, AProcessIsReadyByItsOwnWordNotByThatOfTheOneBefore) {
  service_status_t status{};
  status.service = "a";
  receive({command("a", 10, 4)});
  EXPECT_FALSE(sheriff_.commands().at("a").ready()) << "it has said nothing";
  status.uptime = 1'000'000;
  sheriff_.on(status, kNow);
  EXPECT_FALSE(sheriff_.commands().at("a").ready()) << "so early it does not say what it misses";
  status.uptime = 3'000'000;
  sheriff_.on(status, kNow);
  EXPECT_TRUE(sheriff_.commands().at("a").ready());
  receive({command("a", 11, 5)});
  EXPECT_FALSE(sheriff_.commands().at("a").ready());
  status.num_faults = 1;
  status.fault = {"no LiDAR"};
  sheriff_.on(status, kNow);
  EXPECT_FALSE(sheriff_.commands().at("a").ready());
}

TEST_F(SheriffTest, TellsWhatADeputySaysOfItsCommands) {
  receive({command("a", 10, 4)});
  service_status_t status{};
  status.service = "deputy:d";
  status.num_faults = 1;
  status.fault = {"a has said nothing for 8 s"};
  EXPECT_TRUE(sheriff_.notes(kNow).empty());
  sheriff_.on(status, kNow);
  EXPECT_THAT(sheriff_.notes(kNow), ElementsAre("deputy:d: a has said nothing for 8 s"));
  EXPECT_TRUE(sheriff_.notes(kNow + 6'000'000).empty()) << "it is gone";
}

TEST_F(SheriffTest, TwoDeputiesWithTheSameCommandsAreTwoStacks) {
  for (int i = 0; i < 3; ++i) {
    sheriff_.on(report({command("a", 10, 4), command("b", 11, 4)}, "one"), kNow + 1'000'000 * i);
    sheriff_.on(report({command("a", 20, 4), command("b", 21, 4), command("c", 22, 4)}, "two"),
                kNow + 1'000'000 * i + 300'000);
  }
  EXPECT_THAT(sheriff_.notes(kNow + 3'000'000),
              ElementsAre("deputies one and two both have 2 of these commands: two stacks on one bus"));
  EXPECT_EQ(sheriff_.commands().at("a").restarts, 0);
  EXPECT_TRUE(sheriff_.notes(kNow + 9'000'000).empty());
  sheriff_.on(report({command("a", 30, 1)}, "one"), kNow + 20'000'000);
  EXPECT_TRUE(sheriff_.notes(kNow + 20'000'000).empty()) << "a command that moved";
}

TEST_F(SheriffTest, AStartFailsWhenTheCommandDoes) {
  receive({command("a", 0, 0), command("b", 0, 0)});
  sheriff_.start("a");
  sheriff_.start("b");
  receive({command("a", 0, 1, 0x300), command("b", 0, 1, 0)});
  EXPECT_EQ(sheriff_.progress("a"), Progress::kFailed);
  EXPECT_EQ(sheriff_.progress("b"), Progress::kDone) << "it has done its work";
}

TEST_F(SheriffTest, AStopIsDoneWhenAReportSaysSo) {
  receive({command("a", 10, 4)});
  sheriff_.stop("a");
  EXPECT_EQ(sheriff_.orders("d", kNow)->cmds[0].force_quit, 1);
  receive({command("a", 10, 4)});
  EXPECT_EQ(sheriff_.progress("a"), Progress::kUnderWay);
  receive({command("a", 0, 4, 2)});
  EXPECT_EQ(sheriff_.progress("a"), Progress::kDone);
}

TEST_F(SheriffTest, StartingWhatRunsChangesNothing) {
  receive({command("a", 10, 4)});
  sheriff_.start("a");
  EXPECT_EQ(sheriff_.orders("d", kNow)->cmds[0].desired_runid, 4);
}

TEST(SheriffClaims, OfTwoThatComeTogetherTheLaterOneGivesWay) {
  Sheriff earlier("host:2:1", kNow), later("host:1:1", kNow + 1);
  earlier.on(later.claim(), kNow + 500'000);
  later.on(earlier.claim(), kNow + 500'000);
  EXPECT_EQ(earlier.other(), "");
  EXPECT_EQ(later.other(), "host:2:1");
  EXPECT_EQ(earlier.claim().deputy_id, "") << "no deputy obeys it";

  Sheriff a("host:1:1", kNow), b("host:2:1", kNow);
  a.on(b.claim(), kNow);
  b.on(a.claim(), kNow);
  EXPECT_EQ(a.other(), "") << "one of the same microsecond gives way too";
  EXPECT_EQ(b.other(), "host:1:1");
}

TEST_F(SheriffTest, KnowsAnotherSheriffByItsOrdersButNotFromAPlayedLog) {
  procman_lcm::orders_t orders{};
  orders.sheriff_id = "other:2:2";
  orders.deputy_id = "d";
  orders.utime = kNow - 6'000'000;
  sheriff_.on(orders, kNow);
  EXPECT_EQ(sheriff_.other(), "");
  orders.utime = kNow;
  sheriff_.on(orders, kNow);
  EXPECT_EQ(sheriff_.other(), "other:2:2");
}

TEST_F(SheriffTest, AReportFromAPlayedLogIsLeftOut) {
  receive({command("a", 10, 4)}, 31'000'000);
  EXPECT_TRUE(sheriff_.commands().empty());
}

TEST_F(SheriffTest, RunIdsGoOnAtOneAfterTheLargest) {
  receive({command("a", 10, INT32_MAX)});
  sheriff_.restart("a");
  EXPECT_EQ(sheriff_.orders("d", kNow)->cmds[0].desired_runid, 1);
}

TEST_F(SheriffTest, TheTableShowsFaultsInWordsAndNoControlCharacters) {
  receive({command("a", 10, 1), command("b", 0, 1, 0x0b), command("c", 0, 1, 0x200)});
  service_status_t status{};
  status.service = "a";
  status.fault = {"no \x1b[2Jdata"};
  sheriff_.on(status, kNow);
  const std::string table = table_of(sheriff_, kNow + 2'500'000);
  EXPECT_THAT(table, HasSubstr("running"));
  EXPECT_THAT(table, HasSubstr("no    2.5 s  no ?[2Jdata\n"));
  EXPECT_THAT(table, HasSubstr("failed: Segmentation fault"));
  EXPECT_THAT(table, HasSubstr("failed: exit status 2"));
}

TEST_F(SheriffTest, TheTableDoesNotShowTheLastWordOfADeadDeputyAsThePresent) {
  receive({command("a", 10, 1)});
  EXPECT_THAT(table_of(sheriff_, kNow + 5'000'000), HasSubstr("running"));
  const std::string later = table_of(sheriff_, kNow + 5'000'001);
  EXPECT_THAT(later, HasSubstr("unknown: deputy silent"));
  EXPECT_THAT(later, ::testing::Not(HasSubstr("running")));
}

}  // namespace
}  // namespace curbstone::procman::sheriff
