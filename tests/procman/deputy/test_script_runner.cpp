#include "procman/deputy/script_runner.hpp"

#include <gmock/gmock.h>

#include <set>

namespace curbstone::procman::deputy {
namespace {

using ::testing::ElementsAre;

class Scripts : public ::testing::Test {
 protected:
  ScriptRunner runner(const std::string& scripts, const std::string& name) {
    config_ = config::parse_config(
        R"(group "g" { cmd "a" { exec = "a"; deputy = "d"; } cmd "b" { exec = "b"; deputy = "d"; } }
                              cmd "c" { exec = "c"; deputy = "d"; })" +
            scripts,
        "x");
    EXPECT_THAT(config::check_config(config_), ElementsAre());
    return {config_,
            name,
            {[this](const std::string& id) { done_.push_back("start " + id); },
             [this](const std::string& id) { done_.push_back("stop " + id); },
             [this](const std::string& id) { done_.push_back("restart " + id); },
             [this](const std::string& id, config::WaitStatus) { return satisfied_.contains(id); }}};
  }
  config::Config config_;
  std::vector<std::string> done_;
  std::set<std::string> satisfied_;
};

TEST_F(Scripts, RunWithoutWaitsAtOnce) {
  auto script = runner(
      R"(script "s" { start group "g"; stop cmd "c"; run_script "t"; } script "t" { restart everything; })", "s");
  script.step(0);
  EXPECT_TRUE(script.done());
  EXPECT_THAT(done_, ElementsAre("start a", "start b", "stop c", "restart a", "restart b", "restart c"));
}

TEST_F(Scripts, WaitForTime) {
  auto script = runner(R"(script "s" { start cmd "a"; wait ms 500; start cmd "b"; })", "s");
  script.step(1'000'000);
  script.step(1'499'999);
  EXPECT_THAT(done_, ElementsAre("start a"));
  script.step(1'500'000);
  EXPECT_THAT(done_, ElementsAre("start a", "start b"));
}

TEST_F(Scripts, WaitForAllOfAGroupAndThenATenthOfASecondAfterTheLastAction) {
  auto script = runner(R"(script "s" { start group "g" wait "running"; start cmd "c"; })", "s");
  script.step(0);
  satisfied_ = {"a"};
  script.step(10'000);
  satisfied_ = {"a", "b"};
  script.step(20'000);
  EXPECT_THAT(done_, ElementsAre("start a", "start b"));
  script.step(99'999);
  EXPECT_FALSE(script.done());
  script.step(100'000);
  EXPECT_THAT(done_, ElementsAre("start a", "start b", "start c"));
  EXPECT_TRUE(script.done());
}

TEST_F(Scripts, WaitStatementsHoldUntilSatisfied) {
  auto script = runner(R"(script "s" { wait cmd "a" status "stopped"; stop cmd "b"; })", "s");
  for (int i = 0; i < 100; ++i) script.step(i * 1'000'000);
  EXPECT_THAT(done_, ElementsAre());
  satisfied_ = {"a"};
  script.step(100'000'000);
  EXPECT_THAT(done_, ElementsAre("stop b"));
}

}  // namespace
}  // namespace curbstone::procman::deputy
