#include "common/config/standard_streams.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace curbstone {
namespace {

/// A program that prints, to where its standard output leads, and ends well.
[[noreturn]] void print_and_end(const char* to, int lines = 1) {
  if (std::freopen(to, "w", stdout) == nullptr) std::exit(9);
  guard_standard_streams();
  guard_standard_streams();
  for (int i = 0; i < lines; ++i) std::fputs("what somebody wants to know\n", stdout);
  std::exit(0);
}

TEST(StandardStreams, AFullDiskIsSaidAndIsAFailure) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(print_and_end("/dev/null"), ::testing::ExitedWithCode(0), "^$");
  EXPECT_EXIT(print_and_end("/dev/full"), ::testing::ExitedWithCode(1),
              "^standard output: cannot be written: No space left on device\n$");
  EXPECT_EXIT(print_and_end("/dev/full", 10'000), ::testing::ExitedWithCode(1), "standard output: cannot be written");
}

TEST(StandardStreams, AReaderThatHasGoneIsNoFailure) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto print_to_nobody = [] {
    int ends[2];
    if (pipe(ends) != 0) std::exit(9);
    signal(SIGPIPE, SIG_IGN);
    close(ends[0]);
    dup2(ends[1], STDOUT_FILENO);
    guard_standard_streams();
    std::fputs("what nobody reads\n", stdout);
    std::exit(0);
  };
  EXPECT_EXIT(print_to_nobody(), ::testing::ExitedWithCode(0), "^$");
}

}  // namespace
}  // namespace curbstone
