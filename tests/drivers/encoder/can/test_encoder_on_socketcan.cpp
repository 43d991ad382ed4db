#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

#include "drivers/encoder/can/candump.hpp"
#include "tests/drivers/encoder/can/on_vcan.hpp"

namespace curbstone::encoder::can {
namespace {

TEST_F(EncoderOnSocketCan, TheDriveIsSetUpAndTheWheelsAreRead) {
  ASSERT_TRUE(run_until_more_samples(100));
  EXPECT_TRUE(run_until([&] { return node_->report().faults.empty(); }));
  const Counters counters = node_->report().counters;
  EXPECT_GE(counters["drive.setups"], 1);
  EXPECT_EQ(counters["can.errors"], 0);
  EXPECT_EQ(counters["ignored.frames"], 0);
  const auto& messages = recorder_.messages();
  const wheels_t& first = messages[messages.size() - 50];
  const wheels_t& last = messages.back();
  const double seconds = static_cast<double>(last.utime - first.utime) * 1e-6;
  EXPECT_NEAR(static_cast<double>(last.counts[0] - first.counts[0]) / seconds, 10'000, 1'000);
  EXPECT_NEAR(static_cast<double>(last.counts[1] - first.counts[1]) / seconds, 10'000, 1'000);
}

TEST_F(EncoderOnSocketCan, AnInterfaceThatGoesDownIsAFaultUntilItIsUpAgain) {
  ASSERT_TRUE(run_until_more_samples(20));
  set_up(false);
  EXPECT_TRUE(run_until([&] {
    const auto faults = node_->report().faults;
    return !faults.empty() && faults[0].find("vcan0") != std::string::npos;
  }));
  set_up(true);
  open_bus();
  EXPECT_TRUE(run_until_more_samples(50));
  EXPECT_TRUE(run_until([&] { return node_->report().faults.empty(); }));
  EXPECT_EQ(node_->report().counters["link.reopened"], 1);
}

TEST_F(EncoderOnSocketCan, BusErrorsAreCountedAndABusOffIsAFaultAndRestartedUntilFramesCome) {
  ASSERT_TRUE(run_until_more_samples(20));
  send_error(CAN_ERR_BUSERROR);
  send_error(CAN_ERR_CRTL);
  ASSERT_TRUE(run_until([&] { return node_->report().counters["can.errors"] == 2; }));
  EXPECT_EQ(node_->report().counters["can.bus_off"], 0);

  drive_on_ = false;
  why_no_restart_ = "not today";
  send_error(CAN_ERR_BUSOFF);
  ASSERT_TRUE(run_until_fault("vcan0 is bus-off: cable, terminator or bit rate; it cannot be restarted: not today"));
  ASSERT_TRUE(run_until([&] { return restarts_.size() == 4; }));
  EXPECT_GE(restarts_[1] - restarts_[0], 190'000);
  EXPECT_GE(restarts_[2] - restarts_[1], 390'000);
  EXPECT_GE(restarts_[3] - restarts_[2], 790'000);
  why_no_restart_ = "";
  ASSERT_TRUE(run_until([&] { return node_->report().counters["can.restarts"] >= 1; }));
  send_error(CAN_ERR_RESTARTED);
  drive_on_ = true;
  EXPECT_TRUE(run_until_more_samples(20));
  EXPECT_TRUE(run_until([&] { return node_->report().faults.empty(); }));
  const std::size_t restarts = restarts_.size();
  EXPECT_TRUE(run_until_more_samples(50));
  EXPECT_EQ(restarts_.size(), restarts) << "the bus is on";
  EXPECT_EQ(node_->report().counters["can.bus_off"], 1);
  EXPECT_EQ(node_->report().counters["can.restart_failed"], 4);
}

TEST_F(EncoderOnSocketCan, TheNoiseOfOthersChangesNothing) {
  if (std::system("command -v cangen >/dev/null") != 0) GTEST_SKIP() << "no cangen: can-utils has it";
  ASSERT_TRUE(run_until_more_samples(20));
  const std::int64_t setups = node_->report().counters["drive.setups"];
  const Command extended(std::string("timeout -s KILL 4 cangen ") + kInterface + " -e -g 1");
  const Command standard(std::string("timeout -s KILL 4 cangen ") + kInterface + " -I 3FF -g 1");
  const std::size_t before = recorder_.messages().size();
  ASSERT_TRUE(run_until_more_samples(250));
  const Counters counters = node_->report().counters;
  EXPECT_EQ(counters["refused.length"], 0);
  EXPECT_EQ(counters["refused.jump"], 0);
  EXPECT_EQ(counters["ignored.frames"], 0);
  EXPECT_EQ(counters["drive.setups"], setups);
  const auto& messages = recorder_.messages();
  const double seconds = static_cast<double>(messages.back().utime - messages[before].utime) * 1e-6;
  EXPECT_NEAR(static_cast<double>(messages.back().counts[0] - messages[before].counts[0]) / seconds, 10'000, 1'000);
}

TEST_F(EncoderOnSocketCan, NonsenseOnTheDrivesOwnIdsIsNeverPublished) {
  if (std::system("command -v cangen >/dev/null") != 0) GTEST_SKIP() << "no cangen: can-utils has it";
  ASSERT_TRUE(run_until_more_samples(50));
  {
    const Command positions(std::string("timeout -s KILL 3 cangen ") + kInterface + " -I 181 -g 20");
    const Command sdo(std::string("timeout -s KILL 3 cangen ") + kInterface + " -I 581 -g 20");
    EXPECT_TRUE(run_until([&] {
      const Counters counters = node_->report().counters;
      return counters["refused.jump"] > 20 && counters["refused.length"] > 20 && counters["ignored.sdo"] > 20;
    }));
    EXPECT_TRUE(run_until_fault("of the packets of a second were refused"));
  }
  EXPECT_TRUE(run_until_more_samples(100));
  // The drive goes one way. Its speed tells less: frames that were late on a busy machine come together.
  const auto& messages = recorder_.messages();
  for (std::size_t i = 1; i < messages.size(); ++i) {
    ASSERT_GE(messages[i].counts[0], messages[i - 1].counts[0]) << i;
    ASSERT_GE(messages[i].counts[1], messages[i - 1].counts[1]) << i;
  }
  EXPECT_TRUE(run_until([&] { return node_->report().faults.empty(); }));
}

/// The first frames of a real car, played by canplayer at their own pace.
class RealLogOnSocketCan : public EncoderOnSocketCan {
 protected:
  static constexpr const char* kLog = "/data/fsae_candump.log";
  void SetUp() override {
    config_.configure = false;
    config_.signals = {SignalKind::kCounts, "202 0|8@1+", "202 8|8@1+"};
    config_.max_speed = 10;  // rad/s: half of what a counter of 8 bits can tell
    drive_on_ = false;
    EncoderOnSocketCan::SetUp();
  }
};

TEST_F(RealLogOnSocketCan, EachFrameThatWasAskedForIsRead) {
  if (std::system("command -v canplayer >/dev/null") != 0) GTEST_SKIP() << "no canplayer: can-utils has it";
  std::ifstream log(kLog);
  if (!log) GTEST_SKIP() << kLog << " is not there: can_in_qemu brings it";
  std::vector<CanFrame> played;
  for (std::string text; std::getline(log, text);) {
    const auto line = parse_candump_line(text);
    if (line && !line->other && line->frame.id == 0x202) played.push_back(line->frame);
  }
  ASSERT_GT(played.size(), 1000u);
  CanSocket other(kInterface, {0x202});  // hears the same
  std::vector<CanFrame> heard;
  loop_.every(5ms, [&] {
    for (auto read = other.read(); read.status == CanSocket::Status::kFrame; read = other.read())
      heard.push_back(read.frame);
  });
  const Command player(std::string("canplayer vcan0=can0 -I ") + kLog);
  EXPECT_TRUE(run_until([&] { return heard.size() >= played.size(); }));
  EXPECT_TRUE(heard == played) << heard.size() << " of " << played.size();
  EXPECT_TRUE(run_until([&] {
    return node_->report().counters["can.frames"] == static_cast<std::int64_t>(played.size());
  })) << node_->report().counters["can.frames"]
      << " of " << played.size();
  EXPECT_EQ(node_->report().counters["refused.length"], 0);
}

}  // namespace
}  // namespace curbstone::encoder::can
