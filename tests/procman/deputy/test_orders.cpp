#include "procman/deputy/orders.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace curbstone::procman::deputy {
namespace {

struct Case {
  bool running;
  int actual;
  int desired;
  bool force_quit;
  OrderStep step;
};
class Orders : public ::testing::TestWithParam<Case> {};

TEST_P(Orders, DecideOneStep) {
  const Case& c = GetParam();
  EXPECT_EQ(decide(c.running, c.actual, c.desired, c.force_quit), c.step);
}

INSTANTIATE_TEST_SUITE_P(Table, Orders,
                         ::testing::Values(Case{false, 0, 0, false, OrderStep::kNothing},    // registered only
                                           Case{false, 0, 1, false, OrderStep::kStart},      //
                                           Case{false, 1, 1, false, OrderStep::kTakeRunId},  // ended: not run again
                                           Case{false, 1, 2, true, OrderStep::kTakeRunId},   //
                                           Case{false, 3, 0, false, OrderStep::kStart},      // as upstream
                                           Case{true, 1, 1, false, OrderStep::kTakeRunId},   //
                                           Case{true, 1, 2, false, OrderStep::kStop},        // restart: stop first
                                           Case{true, 1, 1, true, OrderStep::kStop},         //
                                           Case{true, 1, 0, false, OrderStep::kNothing},  // a new sheriff: let it run
                                           Case{true, 1, 0, true, OrderStep::kStop}));

TEST(Orders, WhatIsOutOfRangeOnTheWireBecomesTheDefault) {
  procman_lcm::cmd_t wire;
  wire.command_id = "a";
  wire.exec_str = "x";
  wire.auto_respawn = 1;
  wire.stop_signal = -3;
  wire.stop_time_allowed = std::nanf("");
  const auto command = command_from_wire(wire, "d");
  ASSERT_TRUE(command);
  EXPECT_EQ(*command, (config::Command{"a", "x", "d", "", true, 2, 7}));
  wire.stop_signal = 15;
  wire.stop_time_allowed = 1.5F;
  EXPECT_EQ(command_from_wire(wire, "d")->stop_signal, 15);
  EXPECT_EQ(command_from_wire(wire, "d")->stop_time_allowed, 1.5);
}

TEST(Orders, WithoutIdOrExecAreRefused) {
  procman_lcm::cmd_t wire;
  wire.command_id = "";
  wire.exec_str = "x";
  EXPECT_FALSE(command_from_wire(wire, "d"));
  wire.command_id = "a";
  wire.exec_str = "";
  EXPECT_FALSE(command_from_wire(wire, "d"));
  wire.exec_str = std::string(20000, 'x');
  EXPECT_FALSE(command_from_wire(wire, "d"));
}

}  // namespace
}  // namespace curbstone::procman::deputy
