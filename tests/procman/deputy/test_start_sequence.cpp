#include "procman/deputy/start_sequence.hpp"

#include <gmock/gmock.h>

#include <set>

namespace curbstone::procman::deputy {
namespace {

using ::testing::ElementsAre;

struct Started {
  std::vector<std::string> ids;
  std::set<std::string> up;
  StartSequence sequence{{{"lidar", "imu"}, {"ekf"}, {"map"}},
                         {[this](const std::string& id) { ids.push_back(id); },
                          [this](const std::string& id) { return up.contains(id); }}};
};

TEST(StartSequence, BeginsWithTheSinkAndKeepsTheSourcesUntilAllListen) {
  Started s;
  EXPECT_FALSE(s.sequence.step(1));
  EXPECT_THAT(s.ids, ElementsAre("map", "ekf")) << "neither waits for the other";
  s.up = {"map"};
  EXPECT_FALSE(s.sequence.step(2));
  EXPECT_EQ(s.ids.size(), 2U);
  s.up.insert("ekf");
  EXPECT_TRUE(s.sequence.step(3));
  EXPECT_THAT(s.ids, ElementsAre("map", "ekf", "imu", "lidar"));
}

TEST(StartSequence, GoesOnWithoutOneThatDoesNotComeUp) {
  Started s;
  EXPECT_FALSE(s.sequence.step(0));
  EXPECT_FALSE(s.sequence.step(StartSequence::kPatience - 1));
  EXPECT_THAT(s.ids, ElementsAre("map", "ekf"));
  EXPECT_TRUE(s.sequence.step(StartSequence::kPatience));
  EXPECT_EQ(s.ids.size(), 4U);
  EXPECT_TRUE(s.sequence.step(3 * StartSequence::kPatience));
  EXPECT_EQ(s.ids.size(), 4U) << "once";
}

TEST(StartSequence, OfOneStageOrNoneIsSoonOver) {
  std::vector<std::string> ids;
  const StartSequence::Callbacks callbacks{[&](const std::string& id) { ids.push_back(id); },
                                           [](const auto&) { return false; }};
  EXPECT_TRUE(StartSequence({{"a", "b"}}, callbacks).step(1));
  EXPECT_THAT(ids, ElementsAre("b", "a"));
  EXPECT_TRUE(StartSequence({}, callbacks).step(1));
}

}  // namespace
}  // namespace curbstone::procman::deputy
