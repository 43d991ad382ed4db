#include "common/terminal/terminal_table.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

#include "common/terminal/screen.hpp"

namespace curbstone {
namespace {

using ::testing::ElementsAre;
using Align = TerminalTable::Align;

TerminalTable example() {
  TerminalTable table({{"channel"}, {"Hz", Align::kRight, 6}, {"state"}});
  table.add_row({{"IMU"}, {"99.8"}, {"ok", Colour::kGood}});
  table.add_row({{"LIDAR_POINTS"}, {"750.0", Colour::kBad}});
  return table;
}

TEST(TerminalTable, ColumnsAreAsWideAsTheirWidestCell) {
  EXPECT_THAT(example().lines(), ElementsAre("channel           Hz  state",  //
                                             "IMU             99.8  ok",     //
                                             "LIDAR_POINTS   750.0"));
}

TEST(TerminalTable, ColoursAreForTerminalsOnly) {
  const auto lines = example().lines({true, 0});
  EXPECT_EQ(lines[1], "IMU             99.8  \x1b[32mok\x1b[0m");
  EXPECT_EQ(lines[2], "LIDAR_POINTS   \x1b[31m750.0\x1b[0m");
}

TEST(TerminalTable, LinesAreCutAtTheWidthOfTheTerminal) {
  EXPECT_THAT(example().lines({false, 5}), ElementsAre("chann", "IMU", "LIDAR"));
  EXPECT_EQ(example().lines({true, 17})[2], "LIDAR_POINTS   \x1b[31m75\x1b[0m") << "colours have no width";
}

TEST(TerminalTable, CharactersAreCountedNotBytes) {
  TerminalTable table({{"a"}, {"b"}});
  table.add_row({{"µs"}, {"x"}});
  table.add_row({{"abc"}, {"y"}});
  EXPECT_THAT(table.lines(), ElementsAre("a    b", "µs   x", "abc  y"));
  EXPECT_EQ(table.lines({false, 1})[1], "µ");
}

TEST(TerminalTable, TextOfOthersCannotSteerTheTerminal) {
  EXPECT_EQ(printable("a\x1b[2Jb\n\x7f"), "a?[2Jb??");
  EXPECT_EQ(printable("\xC2\x9B"
                      "2J"),
            "?2J")
      << "the one-byte CSI of C1, as UTF-8";
  EXPECT_EQ(printable("\xFF\xC3"), "??") << "no UTF-8";
  EXPECT_EQ(printable("grün µ €"), "grün µ €");
  EXPECT_EQ(styled_line("a\x1b", Colour::kBad, {true, 0}), "\x1b[31ma?\x1b[0m");
}

TEST(Screen, APictureReplacesTheOneBeforeWithoutScrolling) {
  EXPECT_EQ(screen_bytes({"a", "b", "c"}, 2), "\x1b[Ha\x1b[K\r\nb\x1b[K\x1b[J");
  EXPECT_EQ(screen_bytes({}, 10), "\x1b[H\x1b[J");
}

TEST(Screen, APipeGetsPlainLines) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const Screen screen(ends[1]);
  EXPECT_FALSE(screen.is_terminal());
  EXPECT_FALSE(screen.style().colours);
  ASSERT_TRUE(screen.show({"a", "b"}));
  char bytes[16] = {};
  EXPECT_EQ(read(ends[0], bytes, sizeof bytes), 4);
  EXPECT_STREQ(bytes, "a\nb\n");
  close(ends[0]);
  close(ends[1]);
}

TEST(Screen, TellsAReaderThatHasGoneFromADiskThatIsFull) {
  const int full = open("/dev/full", O_WRONLY);
  EXPECT_THAT([&] { Screen(full).show({"a"}); }, ::testing::ThrowsMessage<std::runtime_error>(
                                                     "standard output: cannot be written: No space left on device"));
  close(full);
  signal(SIGPIPE, SIG_IGN);
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  close(ends[0]);
  EXPECT_FALSE(Screen(ends[1]).show({"a"}));
  close(ends[1]);
}

}  // namespace
}  // namespace curbstone
