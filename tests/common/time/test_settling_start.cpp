#include "common/time/settling_start.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

namespace curbstone {
namespace {

struct StampedSample {
  std::int64_t utime;
};

class SettlingStartTest : public ::testing::Test {
 protected:
  void pass(std::int64_t utime, std::int64_t received, std::int64_t earlier = 0) {
    start_.move_earlier(earlier);
    start_.pass({utime}, received, send_);
  }
  SettlingStart<StampedSample> start_;
  std::vector<std::int64_t> sent_;
  std::function<void(const StampedSample&)> send_ = [this](const StampedSample& sample) {
    sent_.push_back(sample.utime);
  };
};

TEST_F(SettlingStartTest, WhatCameFirstWaitsAndIsPutEarlierByWhatComesLater) {
  start_.begin(25'000);
  pass(25'000, 25'000);
  pass(25'000, 25'000, 10'000);
  pass(30'000, 30'000, 5'000);
  EXPECT_TRUE(sent_.empty());
  pass(125'000, 125'000);
  EXPECT_EQ(sent_, (std::vector<std::int64_t>{10'000, 20'000, 30'000, 125'000}));
  pass(135'000, 136'000, 7'000);
  EXPECT_EQ(sent_.back(), 135'000) << "what has gone out stays";
}

TEST_F(SettlingStartTest, ASampleThatIsRefusedTellsOfTheOthersToo) {
  start_.begin(25'000);
  pass(25'000, 25'000);
  start_.move_earlier(10'000);
  pass(25'000, 25'000);
  pass(125'000, 125'000);
  EXPECT_EQ(sent_, (std::vector<std::int64_t>{15'000, 25'000, 125'000}));
}

TEST_F(SettlingStartTest, WithoutABeginningNothingWaits) {
  pass(10, 10);
  EXPECT_EQ(sent_.size(), 1u);
}

TEST_F(SettlingStartTest, HoldsNoMoreThanItsBoundAndGivesUpAllWhenAsked) {
  start_.begin(0);
  for (std::size_t i = 0; i < start_.kMaxWaiting - 1; ++i) pass(static_cast<std::int64_t>(i), 0);
  EXPECT_TRUE(sent_.empty());
  pass(5000, 0);
  EXPECT_EQ(sent_.size(), start_.kMaxWaiting);
  start_.begin(0);
  pass(6000, 0);
  start_.release(send_);
  EXPECT_EQ(sent_.back(), 6000);
}

}  // namespace
}  // namespace curbstone
