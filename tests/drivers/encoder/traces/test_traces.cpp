#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "common/time/clock.hpp"
#include "drivers/encoder/encoder_node.hpp"
#include "drivers/encoder/traces/file_link.hpp"
#include "drivers/encoder/traces/pcan_trace.hpp"
#include "drivers/encoder/traces/trace_file.hpp"
#include "drivers/encoder/traces/trace_time.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::encoder::traces {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Kind = PcanTrace::Line::Kind;

constexpr std::int64_t kStart = 1'649'163'686'039'000;  // 2022-04-05 13:01:26.039

std::string why(const std::string& path) {
  try {
    TraceFile file(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(PcanTraceTest, ReadsAFileOfVersion11) {
  PcanTrace trace;
  EXPECT_EQ(trace.parse(";$FILEVERSION=1.1\r").kind, Kind::kComment);
  EXPECT_EQ(trace.parse(";$STARTTIME=44656.5426624884").kind, Kind::kComment);
  EXPECT_EQ(trace.parse(";   |         Time Offset (ms)").kind, Kind::kComment);
  const auto line = trace.parse("     2)        72.1  Rx         010A  8  AB 02 22 0E 99 8C 00 00 \r");
  ASSERT_EQ(line.kind, Kind::kFrame);
  EXPECT_EQ(line.frame, can::CanFrame::make(0x10A, {0xAB, 0x02, 0x22, 0x0E, 0x99, 0x8C, 0, 0}));
  EXPECT_NEAR(static_cast<double>(line.utime - kStart), 72'100, 1'000);
  const auto extended = trace.parse("     3)     1284.0  Tx     0000012A  1  11");
  ASSERT_EQ(extended.kind, Kind::kFrame);
  EXPECT_TRUE(extended.frame.extended);
  const auto remote = trace.parse("     4)     7468.9  Tx         0000  8  RTR");
  ASSERT_EQ(remote.kind, Kind::kFrame);
  EXPECT_TRUE(remote.frame.remote);
  EXPECT_EQ(trace.parse("     5)     7469.0  Warng  FFFFFFFF  4  00 00 00 08  BUSHEAVY").kind, Kind::kOther);
  EXPECT_EQ(trace.parse("     6)     7469.1  Error      0008  4  00 19 08 08").kind, Kind::kOther);
}

TEST(PcanTraceTest, ReadsAFileOfVersion21ByItsColumns) {
  PcanTrace trace;
  (void)trace.parse(";$FILEVERSION=2.1");
  (void)trace.parse(";$COLUMNS=N,O,T,B,I,d,R,L,D");
  const auto line = trace.parse("      1      1059.900 DT 1      0300 Rx -  7    00 00 00 00 04 00 00");
  ASSERT_EQ(line.kind, Kind::kFrame);
  EXPECT_EQ(line.utime, 1'059'900);
  EXPECT_EQ(line.bus, "1");
  EXPECT_EQ(line.frame, can::CanFrame::make(0x300, {0, 0, 0, 0, 4, 0, 0}));
  const auto remote = trace.parse("     10      1336.543 RR 1      0100 Rx -  3");
  EXPECT_EQ(remote.kind, Kind::kFrame);
  EXPECT_TRUE(remote.frame.remote);
  const auto extended = trace.parse("      9      1335.156 DT 2  18EFC034 Tx -  2    01 02");
  EXPECT_EQ(extended.frame.id, 0x18EFC034u);
  for (const char* other : {"      5      1334.416 FD 1      0500 Tx - 12    01 02 03 04 05 06 07 08 09 0A 0B 0C",
                            "      6      1334.222 ER 1         - Rx -  5    04 00 02 00 00",
                            "      7      1334.224 EV 1  User-defined event for bus 1"}) {
    EXPECT_EQ(trace.parse(other).kind, Kind::kOther) << other;
  }
}

TEST(PcanTraceTest, WhatIsNoLineIsRefused) {
  for (const char* line : {"1) 2.0 Rx 0800 1 00", "1) 2.0 Rx 012 9 00", "1) 2.0 Rx 012 2 00", "1) 2.0 Rx 012 1 00 00",
                           "1) -2.0 Rx 012 1 00", "1) x Rx 012 1 00", "1) nan Rx 012 1 00", "1) 2.0 Rx 012 1 0G",
                           "1) 2.0 Rx", "1)", "nonsense", "1) 2.0 Rx 12345 1 00", "1) 1e300 Rx 012 1 00"}) {
    PcanTrace trace;
    EXPECT_NE(trace.parse(line).kind, Kind::kFrame) << line;
  }
  PcanTrace trace;
  (void)trace.parse(";$COLUMNS=N,O,T");
  EXPECT_EQ(trace.parse("1 2.0 DT 1 012 Rx - 1 00").kind, Kind::kRefused);
}

TEST(PcanTraceTest, DamagedLinesOfEveryShapeAreSurvived) {
  std::mt19937 random(4);
  const std::string good = "     2)        72.1  Rx         010A  8  AB 02 22 0E 99 8C 00 00 ";
  const std::string columns = ";$COLUMNS=N,O,T,B,I,d,R,L,D";
  PcanTrace trace;
  for (int i = 0; i < 200'000; ++i) {
    std::string text = i % 20 == 0 ? columns : good;
    text.resize(random() % (text.size() + 1));
    for (unsigned changes = random() % 4; changes > 0 && !text.empty(); --changes)
      text[random() % text.size()] = static_cast<char>(random() % 256);
    const auto line = trace.parse(text);
    ASSERT_LE(line.frame.size, 8);
  }
}

TEST(TraceFileTest, ARealTraceIsReadWhole) {
  const std::string path = test::data_path("can/pcan2.trc");
  if (!std::ifstream(path)) GTEST_SKIP() << path << " is not there";
  TraceFile file(path);
  int frames = 0;
  std::int64_t last = 0;
  for (auto frame = file.next(); frame; frame = file.next(), ++frames) {
    EXPECT_GE(frame->utime, last);
    last = frame->utime;
  }
  EXPECT_EQ(frames, 6968);
  EXPECT_THAT(file.counters().values(), IsEmpty());
}

TEST(TraceFileTest, ARealCandumpIsReadWhole) {
  const std::string path = test::data_path("can/fsae_candump.log");
  if (!std::ifstream(path)) GTEST_SKIP() << path << " is not there";
  TraceFile file(path);
  int frames = 0;
  while (file.next()) ++frames;
  EXPECT_EQ(frames, 82'661);
}

/// Others may share the bus.
TEST(TraceFileTest, CanFdAndErrorFramesAreIgnoredAndNotRefused) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "x.log") << "(1.000000) can0 181##1AABB\n(1.000001) can0 181#00\n"
                                     "(1.000002) can0 20000088#0000000000000000\n(1.000003) can0 18\n";
  TraceFile file(folder / "x.log");
  EXPECT_EQ(file.next()->frame.id, 0x181u);
  EXPECT_FALSE(file.next());
  EXPECT_EQ(file.counters()["ignored.trace_line"], 2);
  EXPECT_EQ(file.counters()["refused.trace_line"], 1);
}

/// candump of two interfaces: which one comes first is chance.
TEST(TraceFileTest, TheBusIsThatOnWhichAFrameOfOursComesFirst) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "x.log") << "(1.000000) can0 300#00\n(1.000001) can1 00000181#00\n(1.000002) can1 181#00\n"
                                     "(1.000003) can0 181#00\n(1.000004) can1 182#00\n";
  TraceFile file(folder / "x.log", {0x181, 0x281});
  EXPECT_EQ(file.next()->frame.id, 0x300u) << "nobody knows yet";
  EXPECT_TRUE(file.next()->frame.extended);
  EXPECT_EQ(file.next()->utime, 1'000'002);
  EXPECT_EQ(file.next()->utime, 1'000'004);
  EXPECT_FALSE(file.next());
  EXPECT_EQ(file.counters()["ignored.other_bus"], 1);
}

TEST(TraceFileTest, OnlyTheFirstBusIsRead) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "x.log") << "(1.000000) can0 181#00\n(1.000001) can1 181#00\n(1.000002) can0 182#00\n";
  TraceFile file(folder / "x.log");
  EXPECT_EQ(file.next()->frame.id, 0x181u);
  EXPECT_EQ(file.next()->frame.id, 0x182u);
  EXPECT_FALSE(file.next());
  EXPECT_EQ(file.counters()["ignored.other_bus"], 1);
}

TEST(TraceFileTest, WhatIsNoRecordingIsReportedInALine) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(why(folder / "none"), HasSubstr("No such file"));
  std::ofstream(folder / "letter") << "Dear Sir,\nthis is no recording.\n";
  EXPECT_THAT(why(folder / "letter"), HasSubstr("no CAN frames"));
  std::ofstream(folder / "old.trc") << ";$FILEVERSION=1.3\n  1)  2.0 1 Rx 0100 - 1 00\n";
  EXPECT_THAT(why(folder / "old.trc"), HasSubstr("a PCAN trace of version 1.3; 1.1, 2.0 and 2.1 can be read"));
  std::ofstream(folder / "endless") << std::string(1 << 20, 'x');
  EXPECT_THAT(why(folder / "endless"), HasSubstr("no CAN frames"));
}

/// Two seconds of a CANopen drive that another master has set up: positions each 10 ms, status each 100 ms.
void write_drive(const std::filesystem::path& path) {
  std::ofstream log(path);
  for (int i = 0; i < 200; ++i) {
    const int count = 100 * i;
    const int stamp = 10'000 * i;
    char line[128];
    std::snprintf(line, sizeof line, "(1700000000.%06d) can0 181#%02X%02X0000%02X%02X%s\n", stamp % 1'000'000,
                  count & 0xFF, count >> 8, -count & 0xFF, -count >> 8 & 0xFF, count == 0 ? "0000" : "FFFF");
    std::string text(line);
    if (i >= 100) text.replace(1, 10, "1700000001");
    log << text;
    if (i % 10 == 0) log << text.substr(0, text.find("181#")) << "281#2700270000000000\n";
  }
}

TEST(TraceTimeTest, TimesThatLeadBackOrFarAheadAreRefusedUntilTenAgree) {
  TraceTime time;
  std::int64_t at = 1'700'000'000'000'000;
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(time.take(at += 1000));
    EXPECT_FALSE(time.take(at + 3'600'000'000)) << "an hour ahead";
    EXPECT_TRUE(time.take(at += 1000));
    EXPECT_FALSE(time.take(at - 500'000)) << "out of order";
  }
  EXPECT_EQ(time.jumps(), 0);
  at -= 50'000'000;  // another recording, or a clock that was set
  int refused = 0;
  for (int i = 0; i < 100; ++i) refused += time.take(at += 1000) ? 0 : 1;
  EXPECT_EQ(refused, TraceTime::kAgreeing - 1);
  EXPECT_EQ(time.jumps(), 1);
}

TEST(FileLinkTest, ARecordedDriveBecomesWheelsWithTheRecordedTimes) {
  const test::TemporaryFolder folder;
  write_drive(folder / "drive.log");
  for (const double rate : {0.0, 4.0}) {
    EncoderConfig config;
    config.interface = Interface::kFile;
    test::Recorder<wheels_t> recorder("WHEELS");
    EventLoop loop;
    FileLink link(folder / "drive.log", rate);
    EncoderNode node(config, recorder.bus(), [&](const can::CanFrame& frame) { link.send(frame); });
    node.add_report([&](NodeReport& report) { link.report(report); });
    std::vector<std::string> faults;
    link.attach(loop, {[&](auto utime, const auto& frame) { node.on_frame(utime, frame); },
                       [&](auto now, bool up, const auto& why_not) { node.on_link(now, up, why_not); }});
    loop.every(std::chrono::milliseconds(20), [&] {
      node.tick(wall_clock());
      for (const auto& fault : node.report().faults) faults.push_back(fault);
    });
    const std::int64_t begin = steady_clock();
    loop.run();
    node.finish();
    const std::int64_t least = rate > 0 ? 490'000 : 0;  // us: four times its own pace
    EXPECT_GE(steady_clock() - begin, least);
    ASSERT_EQ(recorder.messages().size(), 200u);
    EXPECT_EQ(recorder.messages().back().utime, 1'700'000'001'990'000);
    EXPECT_EQ(recorder.messages().back().counts[0], 19'900);
    EXPECT_EQ(recorder.messages().back().counts[1], 19'900);
    EXPECT_TRUE(recorder.messages().back().enabled);
    EXPECT_THAT(faults, IsEmpty());
    EXPECT_EQ(node.report().counters["dropped.no_bus"], 0) << "nothing is sent";
  }
}

}  // namespace
}  // namespace curbstone::encoder::traces
