#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "common/time/clock.hpp"
#include "drivers/encoder/encoder_node.hpp"
#include "drivers/encoder/traces/file_link.hpp"
#include "drivers/encoder/traces/trace_file.hpp"
#include "drivers/encoder/traces/trace_time.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::encoder::traces {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string why(const std::string& path) {
  try {
    TraceFile file(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
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

/// One that only has a few frames of one byte would be read, and all others refused.
TEST(TraceFileTest, RecordingsOfOtherKindsAreNamedWithWhatToDo) {
  const test::TemporaryFolder folder;
  for (const auto& [text, says] : std::vector<std::pair<std::string, std::string>>{
           {" (1.5)  can0  701   [1]  05\n (1.6)  can0  181   [4]  FE`00`C0`0B\n",
            "(candump -S); record with candump -l"},
           {"  can0  181   [4]  FE`00`C0`0B\n", "(candump -S)"},
           {" (1.5)  can0  RX - -  181   [2]  00001011 11000000\n", "(candump -i); record with candump -l"},
           {"\x1b[31m (1.5)  can0  181   [2]  0B C0\x1b[0m\n", "(candump -c); take them out with sed"},
           {"date Mon Nov 23 20:52:00 2026\nbase hex  timestamps absolute\n", "a Vector ASC file; make a candump log"},
           {"base hex  timestamps absolute\n", "asc2log -I FILE -O drive.log"},
           {std::string("LOGG\0\0", 6), "a Vector BLF file"}}) {
    std::ofstream(folder / "x.log") << text;
    EXPECT_THAT(why(folder / "x.log"), HasSubstr(says)) << text;
  }
  std::ofstream(folder / "x.log")
      << " (1.5)  can0  181   [2]  0B 60   '.`'\n (1.6)  can0  181   [8]  00 01 10 11 00 01 10 11\n";
  EXPECT_EQ(why(folder / "x.log"), "") << "candump -a";
}

TEST(TraceFileTest, WhatIsNoRecordingIsReportedInALine) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(why(folder / "none"), HasSubstr("No such file"));
  std::ofstream(folder / "letter") << "Dear Sir,\nthis is no recording.\n";
  EXPECT_THAT(why(folder / "letter"),
              HasSubstr("no CAN frames: neither a candump log nor a PCAN trace; line 1: \"Dear Sir,\""));
  std::ofstream(folder / "new.trc") << ";$FILEVERSION=4.0\n  1)  2.0 1 Rx 0100 - 1 00\n";
  EXPECT_THAT(why(folder / "new.trc"),
              HasSubstr("a PCAN trace of version 4.0; 1.0 to 1.3, 2.0, 2.1 and 3.0 can be read"));
  std::ofstream(folder / "colon.trc") << ";$FILEVERSION=1.1\n;\n\n 1)  72:1  Rx  010A  1  AB\n";
  EXPECT_THAT(why(folder / "colon.trc"),
              HasSubstr("a PCAN trace without CAN frames; line 4: \" 1)  72:1  Rx  010A  1  AB\""));
  std::ofstream(folder / "endless") << std::string(1 << 20, 'x');
  EXPECT_THAT(why(folder / "endless"), HasSubstr("no CAN frames"));
  std::ofstream(folder / "fd.log") << "(1.000000) can0 181##1AABB\n(1.000001) can0 181##1AABB\n";
  EXPECT_THAT(why(folder / "fd.log"), HasSubstr("no classical CAN frames, only CAN FD, errors or events"));
  std::ofstream(folder / "untimed.log") << "interface = can0\n  can0  181   [2]  AA BB\n";
  EXPECT_THAT(why(folder / "untimed.log"), HasSubstr("line 2 has no time; record with candump -l, -ta or -tz"));
}

/// As editors and Windows programs leave a file: a mark at its beginning, CR LF, and no end of its last line.
TEST(TraceFileTest, AFileThatWasEditedIsRead) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "x.trc") << "\xEF\xBB\xBF;$FILEVERSION=1.1\r\n;$STARTTIME=25570.0\r\n\r\n"
                                     "     1)         0.5  Rx         0181  2  01 02 \r\n"
                                     "     2)         0.9  Rx         0181  2  03 04";
  TraceFile trace(folder / "x.trc");
  EXPECT_EQ(trace.next()->utime, 86'400'000'500);
  EXPECT_EQ(trace.next()->frame, can::CanFrame::make(0x181, {3, 4}));
  EXPECT_FALSE(trace.next());
  EXPECT_THAT(trace.counters().values(), IsEmpty());
  std::ofstream(folder / "x.log") << "\xEF\xBB\xBF(1.5) can0 181#0102\r\n\r\n(1.6) can0 181#0304";
  TraceFile log(folder / "x.log");
  EXPECT_EQ(log.next()->utime, 1'500'000);
  EXPECT_EQ(log.next()->utime, 1'600'000);
  EXPECT_FALSE(log.next());
  EXPECT_THAT(log.counters().values(), IsEmpty());
}

/// A file of PCAN's version 1.0 does not name it.
TEST(TraceFileTest, AFileOfVersion10IsKnownByItsFirstFrame) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "x.trc")
      << ";##########\n;   C:\\x.trc\n;----+-   ---+---  ----+---  +  -+ -- -- ...\n"
         "     1)     17535  00000100  2  01 02\n     2)     17540  FFFFFFFF  4  00 00 00 08 -- -- -- --\n";
  TraceFile file(folder / "x.trc");
  EXPECT_EQ(file.next()->utime, 17'535'000);
  EXPECT_FALSE(file.next());
  EXPECT_EQ(file.counters()["ignored.trace_line"], 1);
}

/// Before the drive is switched on there may be nothing but errors.
TEST(TraceFileTest, TheFirstFrameMayBeFarDown) {
  const test::TemporaryFolder folder;
  std::ofstream log(folder / "x.log");
  for (int i = 0; i < 3000; ++i) log << "(1.000000) can0 20000088#0000000000000000\n";
  log << "(2.000000) can0 181#0102\n" << std::flush;
  TraceFile file(folder / "x.log");
  EXPECT_EQ(file.next()->utime, 2'000'000);
  EXPECT_EQ(file.counters()["ignored.trace_line"], 3000);
}

/// candump -td and -tz look alike. Intervals that are taken for times make wrong speeds.
TEST(TraceFileTest, IntervalsAreNotTakenForTimes) {
  const test::TemporaryFolder folder;
  std::ofstream intervals(folder / "td.log");
  std::ofstream zero(folder / "tz.log");
  std::mt19937 random(7);
  int at = 0;
  for (int i = 0; i < 50; ++i) {
    const int interval = i == 0 ? 0 : 9'900 + static_cast<int>(random() % 200);
    at += interval;
    intervals << fmt::format(" (000.{:06})  can0  181   [1]  00\n", interval);
    zero << fmt::format(" (000.{:06})  can0  181   [1]  00\n", at);
  }
  intervals.close();
  zero.close();
  EXPECT_THAT(why(folder / "td.log"), HasSubstr("the intervals between frames (candump -td)"));
  EXPECT_EQ(why(folder / "tz.log"), "");
}

/// A drive with a punctual clock: positions each 10 ms, and 1 ms behind each tenth its status.
TEST(TraceFileTest, IntervalsThatSeldomGoBackAreNotTakenForTimesEither) {
  const test::TemporaryFolder folder;
  std::ofstream intervals(folder / "td.log");
  std::ofstream joined(folder / "joined.log");
  for (int i = 0; i < 300; ++i) {
    intervals << fmt::format(" (000.{:06})  can0  181   [1]  00\n", i == 0 ? 0 : i % 10 == 1 ? 9'000 : 10'000);
    if (i % 10 == 0) intervals << " (000.001000)  can0  281   [1]  00\n";
    joined << fmt::format(" (000.{:06})  can0  181   [1]  00\n", i % 150 * 1'000);
  }
  intervals.close();
  joined.close();
  EXPECT_THAT(why(folder / "td.log"), HasSubstr("the intervals between frames (candump -td)"));
  EXPECT_EQ(why(folder / "joined.log"), "") << "two recordings";
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
                       [&](auto now, auto state, const auto& why_not) { node.on_link(now, state, why_not); }});
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
