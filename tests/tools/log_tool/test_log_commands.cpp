#include <gmock/gmock.h>

#include "common/log/log_reader.hpp"
#include "tests/tools/log_tool/logged.hpp"

namespace curbstone::log_tool {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using LogCommands = LogToolTest;

std::vector<LogEvent> events_of(const std::string& file) {
  LogReader reader(file);
  std::vector<LogEvent> events;
  while (auto event = reader.next()) events.push_back(std::move(*event));
  return events;
}

TEST_F(LogCommands, WhatIsCutAndJoinedAgainIsTheSameToTheByte) {
  const std::string whole = drive("whole.lcmlog");
  EXPECT_EQ(run({"cut", whole, "--to", "3.3", "--out", path("a.lcmlog")}), 0) << err_;
  EXPECT_EQ(run({"cut", whole, "--from", "3.3", "--to", "2026-11-23T20:52:07.5Z", "--out", path("b.lcmlog")}), 0);
  EXPECT_EQ(run({"cut", whole, "--from", "2026-11-23T20:52:07.5Z", "--out", path("c.lcmlog")}), 0) << err_;
  EXPECT_EQ(events_of(path("a.lcmlog")).size(), 33U + 4U);
  EXPECT_EQ(run({"join", path("c.lcmlog"), path("a.lcmlog"), path("b.lcmlog"), "--out", path("again.lcmlog")}), 0);
  EXPECT_EQ(bytes_of(path("again.lcmlog")), bytes_of(whole));
}

/// Its replay would else be that of a vehicle with the default values.
TEST_F(LogCommands, APartBeginsWithTheConfigurationsFromBeforeIt) {
  {
    LogWriter log(path("whole.lcmlog"));
    for (const char* yaml : {"mapper:\n  vehicle:\n    height: 1.5\n", "mapper:\n  vehicle:\n    height: 1.6\n"})
      write_config(log, "mapper", yaml, kBegin);
    write_config(log, "ekf", "ekf:\n", kBegin);
    for (int i = 0; i < 100; ++i) log.write("IMU", "12345678abcd", 12, kBegin + i * 100'000);
    write_config(log, "mapper", "mapper:\n  vehicle:\n    height: 1.7\n", kBegin + 10'000'000);
  }
  EXPECT_EQ(run({"cut", path("whole.lcmlog"), "--from", "2", "--to", "5", "--out", path("part.lcmlog")}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("30 of 104 messages"));
  const std::vector<LogEvent> events = events_of(path("part.lcmlog"));
  ASSERT_EQ(events.size(), 32U);
  EXPECT_EQ(events[0].channel, "CONFIG");
  EXPECT_EQ(events[1].channel, "CONFIG");
  EXPECT_EQ(events[1].log_utime, kBegin + 2'000'000) << "the part begins where it was told to";
  const std::string newest(events[1].bytes.begin(), events[1].bytes.end());
  EXPECT_THAT(newest, HasSubstr("height: 1.6")) << "of what was published before";

  EXPECT_EQ(run({"cut", path("whole.lcmlog"), "--to", "5", "--out", path("head.lcmlog")}), 0) << err_;
  EXPECT_EQ(events_of(path("head.lcmlog")).size(), 3U + 50U) << "those that it has are not repeated";
}

TEST_F(LogCommands, RepairOfAWholeLogIsTheSameToTheByte) {
  const std::string whole = drive("whole.lcmlog");
  EXPECT_EQ(run({"repair", whole, "--out", path("same.lcmlog")}), 0) << err_;
  EXPECT_EQ(bytes_of(path("same.lcmlog")), bytes_of(whole));
}

TEST_F(LogCommands, RepairWritesAllThatIsReadableAndSaysTheRest) {
  const std::string whole = drive("whole.lcmlog");
  std::string bytes = bytes_of(whole);
  const auto before = events_of(whole).size();
  bytes.replace(bytes.size() / 2, 50, 50, 'x');
  std::ofstream(path("bad.lcmlog"), std::ios::binary) << bytes;
  EXPECT_EQ(run({"repair", path("bad.lcmlog"), "--out", path("good.lcmlog")}), 0) << err_;
  EXPECT_THAT(err_, HasSubstr("damaged at"));
  EXPECT_GE(events_of(path("good.lcmlog")).size(), before - 2);
  EXPECT_EQ(run({"info", path("good.lcmlog")}), 0) << "whole, and numbered anew";
  EXPECT_EQ(run({"info", path("bad.lcmlog")}), 1);
  EXPECT_EQ(run({"join", path("bad.lcmlog"), "--out", path("joined.lcmlog")}), 1) << "the status tells of loss";
}

TEST_F(LogCommands, FilterTakesTheChannelsThatFitOrTheOthers) {
  const std::string whole = drive("whole.lcmlog");
  EXPECT_EQ(run({"filter", whole, "--channels", "WH.*|GNSS", "--out", path("wheels.lcmlog")}), 0) << err_;
  EXPECT_EQ(run({"filter", whole, "--channels", "WH.*|GNSS", "--not", "--out", path("imu.lcmlog")}), 0) << err_;
  for (const LogEvent& event : events_of(path("wheels.lcmlog"))) EXPECT_EQ(event.channel, "WHEELS");
  EXPECT_EQ(events_of(path("wheels.lcmlog")).size(), 10U);
  EXPECT_EQ(events_of(path("imu.lcmlog")).size(), 100U);
  EXPECT_EQ(run({"filter", whole, "--channels", "WHEEL", "--out", path("none.lcmlog")}), 0);
  EXPECT_THAT(out_, HasSubstr("0 of 110 messages")) << "a part of a name is not the name";
  EXPECT_EQ(run({"filter", whole, "--channels", "(", "--out", path("x.lcmlog")}), 1);
  EXPECT_THAT(err_, HasSubstr("no regular expression"));
}

TEST_F(LogCommands, WhatIsThereIsReplacedOnlyByForce) {
  const std::string whole = drive("whole.lcmlog");
  std::ofstream(path("mine")) << "precious";
  EXPECT_EQ(run({"join", whole, "--out", path("mine")}), 1);
  EXPECT_THAT(err_, HasSubstr("--force"));
  EXPECT_EQ(bytes_of(path("mine")), "precious");
  EXPECT_EQ(run({"join", whole, "--out", path("mine"), "--force"}), 0) << err_;
  EXPECT_EQ(bytes_of(path("mine")), bytes_of(whole));
}

TEST_F(LogCommands, InfoNamesChannelsTypesRatesAndTimes) {
  EXPECT_EQ(run({"info", drive("whole.lcmlog")}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("begins 2026-11-23T20:52:00.000Z, ends 2026-11-23T20:52:09.900Z: 9.9 s, 110 messages"));
  EXPECT_THAT(out_, HasSubstr("curbstone.imu_t"));
  EXPECT_THAT(out_, HasSubstr("unknown (3132333435363738)"));
  EXPECT_THAT(out_, HasSubstr("10.0"));
  EXPECT_THAT(out_, HasSubstr("configuration: none is recorded"));
}

TEST_F(LogCommands, InfoSaysWhereNothingWasRecorded) {
  const std::string whole = drive("whole.lcmlog");
  EXPECT_EQ(run({"cut", whole, "--to", "2", "--out", path("a.lcmlog")}), 0);
  EXPECT_EQ(run({"cut", whole, "--from", "8", "--out", path("b.lcmlog")}), 0);
  EXPECT_EQ(run({"info", path("a.lcmlog"), path("b.lcmlog")}), 0);
  EXPECT_THAT(out_, HasSubstr("nothing recorded: 1.9 .. 8.0 s"));
  EXPECT_THAT(out_, HasSubstr("gap of 6.1 s before " + path("b.lcmlog")));
}

TEST_F(LogCommands, InfoFindsNoGapWhereRecordsAreOutOfOrder) {
  {  // as `curbstone replay --record` writes it: one stage is ahead of the other
    LogWriter log(path("mixed.lcmlog"));
    const auto send = [&](int from, int to, const char* channel) {
      for (int i = from; i < to; ++i) log.write(channel, "12345678abcd", 12, kBegin + i * 100'000);
    };
    send(20, 50, "SLOW");
    send(0, 40, "FAST");
    send(50, 60, "SLOW");
    send(40, 60, "FAST");
    send(90, 95, "FAST");
  }
  EXPECT_EQ(run({"info", path("mixed.lcmlog")}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("nothing recorded: 5.9 .. 9.0 s"));
  EXPECT_EQ(out_.find("nothing recorded"), out_.rfind("nothing recorded")) << out_;
}

TEST_F(LogCommands, InfoSaysWhereTimesGoBack) {
  const std::string whole = drive("whole.lcmlog");
  EXPECT_EQ(run({"info", whole}), 0) << err_;
  EXPECT_THAT(out_, Not(HasSubstr("go back")));
  std::ofstream(path("twice.lcmlog"), std::ios::binary) << bytes_of(whole) << bytes_of(whole);  // cat
  EXPECT_EQ(run({"info", path("twice.lcmlog")}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("times go back by 9.9 s (IMU, WHEELS): two drives in one log, or a clock that was set"));
}

TEST_F(LogCommands, ATimeThatIsNoneIsAClearError) {
  for (const char* time : {"noon", "2026-11-23", "12s", "nan", "2026-11-23T20:52:00.xZ"}) {
    EXPECT_EQ(run({"cut", drive("whole.lcmlog"), "--from", time, "--out", path("a.lcmlog")}), 1) << time;
    EXPECT_THAT(err_, HasSubstr("expected seconds from the beginning")) << time;
  }
}

TEST_F(LogCommands, TimesTheWrongWayRoundAreAnError) {
  const std::string whole = drive("whole.lcmlog");
  EXPECT_EQ(run({"cut", whole, "--from", "5", "--to", "2", "--out", path("a.lcmlog")}), 1);
  EXPECT_THAT(err_, HasSubstr("--from 5 is not before --to 2"));
  EXPECT_FALSE(std::ifstream(path("a.lcmlog")));
  EXPECT_EQ(run({"cut", whole, "--from", "2026-11-23T20:52:07.5Z", "--to", "7", "--out", path("a.lcmlog")}), 1);
}

TEST_F(LogCommands, WrongUsageIsStatusTwo) {
  EXPECT_EQ(run({}), 2);
  EXPECT_EQ(run({"info"}), 2);
  EXPECT_EQ(run({"nothing"}), 2);
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_THAT(out_, HasSubstr("repair"));
}

}  // namespace
}  // namespace curbstone::log_tool
