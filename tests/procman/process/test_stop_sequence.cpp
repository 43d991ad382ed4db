#include "procman/process/stop_sequence.hpp"

#include <gmock/gmock.h>

#include "tests/procman/process/supervised.hpp"

namespace curbstone::procman::process {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

std::vector<std::string> ended(const Supervised& s) {
  std::vector<std::string> ids;
  for (const auto& end : s.ends) ids.push_back(end.id);
  return ids;
}

TEST(StopSequence, StopsOneStageAfterTheOther) {
  Supervised s;
  // The source is the slowest to end; still the sink outlives it.
  s.start(s.add("source", "sh -c 'trap \"sleep 0.3; exit 0\" INT; echo up; while :; do sleep 0.02; done'"));
  for (const char* id : {"middle 1", "middle 2", "sink", "stranger"}) s.start(s.add(id, "sleep 1000"));
  ASSERT_TRUE(s.run_until([&] { return s.output["source"] == "up\r\n"; }));
  StopSequence sequence(s.supervisor, {{"source"}, {"middle 1", "middle 2"}, {"sink", "never started"}});
  ASSERT_TRUE(s.run_until([&] { return sequence.step(steady_clock()); }));
  const auto order = ended(s);
  ASSERT_EQ(order.size(), 5U);
  EXPECT_EQ(order[0], "stranger");
  EXPECT_EQ(order[1], "source");
  EXPECT_THAT((std::vector<std::string>{order[2], order[3]}), UnorderedElementsAre("middle 1", "middle 2"));
  EXPECT_EQ(order[4], "sink");
  EXPECT_THAT(sequence.abandoned(), ElementsAre());
}

TEST(StopSequence, IsBoundedByTheTimeAllowed) {
  Supervised s;
  config::Command stubborn = s.add("stubborn", "sh -c 'trap \"\" INT; echo up; while :; do sleep 0.02; done'");
  stubborn.stop_time_allowed = 0.2;
  s.start(stubborn);
  s.start(s.add("sink", "sleep 1000"));
  ASSERT_TRUE(s.run_until([&] { return s.output["stubborn"] == "up\r\n"; }));
  StopSequence sequence(s.supervisor, {{"stubborn"}, {"sink"}});
  ASSERT_TRUE(s.run_until([&] { return sequence.step(steady_clock()); }));
  EXPECT_THAT(ended(s), ElementsAre("stubborn", "sink"));
  EXPECT_TRUE(s.ends[0].killed);
}

TEST(StopSequence, APendingRespawnIsCancelled) {
  Supervised s;
  config::Command crasher = s.add("crasher", "false");
  crasher.auto_respawn = true;
  s.start(crasher);
  ASSERT_TRUE(s.run_until([&] { return s.ends.size() == 5 && s.supervisor.find("crasher")->pid == 0; }));
  StopSequence sequence(s.supervisor, {{"crasher"}});
  EXPECT_TRUE(sequence.step(steady_clock()));
  s.run_for(0.5);
  EXPECT_EQ(s.ends.size(), 5U);
}

}  // namespace
}  // namespace curbstone::procman::process
