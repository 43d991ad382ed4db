#include "services/ekf/inputs/sequencer.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tests/stamps.hpp"

namespace curbstone::ekf::inputs {
namespace {

using test::kStart;
constexpr std::int64_t kMillisecond = 1'000;

class SequencerTest : public ::testing::Test {
 protected:
  void imu(std::int64_t ms) { push(base::ImuSample{kStart + ms * kMillisecond, {}, {}}); }
  void wheels(std::int64_t ms) { push(base::WheelSample{kStart + ms * kMillisecond, {}}); }
  void increment(std::int64_t ms) {
    MapIncrement m;
    m.begin = kStart + (ms - 500) * kMillisecond;
    m.utime = kStart + ms * kMillisecond;
    sequencer_.push(m);
    while (const auto sample = sequencer_.pop()) note(*sample);
  }
  void drain() {
    while (const auto sample = sequencer_.pop_rest()) note(*sample);
  }

  Sequencer sequencer_{base::EkfConfig{}};
  std::string order_;  ///< "i10 w12 ..." in ms

 private:
  template <class Sample>
  void push(const Sample& sample) {
    sequencer_.push(sample);
    while (const auto sample = sequencer_.pop()) note(*sample);
  }
  void note(const Sequencer::Sample& sample) {
    constexpr std::array kLetters = {"w", "i", "m"};
    const std::int64_t utime = std::visit([](const auto& s) { return s.utime; }, sample);
    order_ += kLetters[sample.index()] + std::to_string((utime - kStart) / kMillisecond) + " ";
  }
};

TEST_F(SequencerTest, WaitsForTheOtherSensorAndMergesByStamp) {
  imu(10);
  imu(20);
  EXPECT_EQ(order_, "");
  wheels(13);
  EXPECT_EQ(order_, "i10 w13 ");
  wheels(23);
  EXPECT_EQ(order_, "i10 w13 i20 ");
  drain();
  EXPECT_EQ(order_, "i10 w13 i20 w23 ");
}

TEST_F(SequencerTest, WheelsGoFirstAtEqualStampsWhicheverComesFirst) {
  imu(10);
  wheels(10);
  wheels(20);
  imu(20);
  drain();
  EXPECT_EQ(order_, "w10 i10 w20 i20 ");
}

TEST_F(SequencerTest, GoesOnWithoutTheOtherSensorAfterTheHold) {
  for (int ms = 0; ms <= 250; ms += 10) imu(ms);
  EXPECT_EQ(order_, "i0 i10 i20 i30 i40 i50 ");
  wheels(100);
  EXPECT_EQ(order_, "i0 i10 i20 i30 i40 i50 i60 i70 i80 i90 w100 i100 ");
}

TEST_F(SequencerTest, WhatComesAfterItsTurnComesAtOnceWithinTheHistory) {
  for (int ms = 0; ms <= 250; ms += 10) imu(ms);
  order_.clear();
  wheels(40);
  EXPECT_EQ(order_, "w40 ");
  for (int ms = 260; ms <= 2500; ms += 10) imu(ms);
  order_.clear();
  wheels(50);
  EXPECT_EQ(order_, "");
  EXPECT_EQ(sequencer_.counters()["dropped.late"], 1);
  EXPECT_EQ(sequencer_.counters()["dropped.late.wheels"], 1);
}

TEST_F(SequencerTest, WhatIsBehindItsOwnChannelComesAfterThatChannelsNewestHoweverTheyInterleave) {
  wheels(10);
  imu(10);
  imu(30);
  wheels(35);  // lets the IMU's 30 through before its 20 has come
  imu(20);
  imu(40);
  wheels(45);
  drain();
  const std::string early = order_;
  order_.clear();
  sequencer_ = Sequencer(base::EkfConfig{});
  for (const int ms : {10, 30, 20, 40}) imu(ms);
  for (const int ms : {10, 35, 45}) wheels(ms);
  drain();
  EXPECT_EQ(order_, "w10 i10 i30 i20 w35 i40 w45 ");
  EXPECT_EQ(early, order_);
  EXPECT_EQ(sequencer_.counters()["disordered.imu"], 1);
}

TEST_F(SequencerTest, DropsDuplicates) {
  imu(10);
  imu(10);
  imu(20);
  drain();
  EXPECT_EQ(order_, "i10 i20 ");
  EXPECT_EQ(sequencer_.counters()["dropped.duplicate.imu"], 1);
}

TEST_F(SequencerTest, AMapIncrementTakesItsTurnAFixedTimeAfterItsEndHoweverEarlyItComes) {
  const auto run = [&](int arrival) {
    order_.clear();
    sequencer_ = Sequencer(base::EkfConfig{});
    for (int ms = 0; ms <= 400; ms += 100) {
      if (ms == arrival) increment(20);
      imu(ms);
      wheels(ms);
    }
    return order_;
  };
  const std::string expected = "w0 i0 w100 i100 w200 i200 w300 i300 m20 w400 i400 ";
  EXPECT_EQ(run(100), expected);
  EXPECT_EQ(run(300), expected);
  EXPECT_EQ(run(400), expected);
  increment(60);
  EXPECT_EQ(sequencer_.counters()["dropped.late.map"], 1);
}

TEST_F(SequencerTest, OneStrayStampDoesNotTakeTheClockAway) {
  imu(10);
  imu(1'000'000'000);
  imu(20);
  imu(-1'000'000'000);
  imu(30);
  drain();
  EXPECT_EQ(order_, "i10 i20 i30 ");
  EXPECT_EQ(sequencer_.counters()["dropped.stray_stamp.imu"], 2);
}

TEST_F(SequencerTest, FollowsAClockThatJumpsForward) {
  imu(10);
  wheels(10);
  for (int ms = 5000; ms < 5050; ms += 10) {
    imu(ms);
    wheels(ms);
  }
  drain();
  EXPECT_EQ(order_, "w10 i10 w5020 i5020 w5030 i5030 w5040 i5040 ");
}

TEST_F(SequencerTest, FollowsAClockThatIsTurnedBack) {
  for (int ms = 9000; ms <= 9100; ms += 10) {
    imu(ms);
    wheels(ms);
  }
  order_.clear();
  for (int ms = 100; ms <= 160; ms += 10) {
    imu(ms);
    wheels(ms);
  }
  drain();
  EXPECT_EQ(order_, "w120 i120 w130 i130 w140 i140 w150 i150 w160 i160 ");
  EXPECT_EQ(sequencer_.counters()["jumps.imu"] + sequencer_.counters()["jumps.wheels"], 1);
}

TEST_F(SequencerTest, IsBoundedWhenTheClocksHaveNothingToDoWithEachOther) {
  for (int ms = 0; ms < 100'000; ms += 10) {
    imu(ms);
    wheels(ms + 3'600'000);
  }
  EXPECT_LT(order_.size(), 400'000U);
  EXPECT_GT(sequencer_.counters()["dropped.late.imu"], 9'000);  // the wheels' clock has won
  EXPECT_NE(order_.find("w3600000 "), std::string::npos);
}

}  // namespace
}  // namespace curbstone::ekf::inputs
