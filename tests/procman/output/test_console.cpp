#include "procman/output/console.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <string>
#include <utility>

#include "common/time/clock.hpp"

namespace curbstone::procman::output {
namespace {

class OnAPipe : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(pipe2(ends_.data(), O_CLOEXEC), 0); }
  void TearDown() override {
    close(ends_[0]);
    if (ends_[1] >= 0) close(ends_[1]);
  }
  /// All that was written, after the writer's end was closed.
  std::string read_all() {
    close(std::exchange(ends_[1], -1));
    while (read_some()) {
    }
    return got_;
  }
  bool read_some() {
    std::array<char, 4096> buffer{};
    const ssize_t size = read(ends_[0], buffer.data(), buffer.size());
    if (size > 0) got_.append(buffer.data(), static_cast<std::size_t>(size));
    return size > 0;
  }
  std::string got_;
  std::array<int, 2> ends_{};
};

TEST_F(OnAPipe, TheLastLinesArePrintedBeforeItEnds) {
  {
    Console console(ends_[1]);
    console.print("first");
    console.print("last");
  }
  EXPECT_EQ(read_all(), "first\nlast\n");
}

TEST_F(OnAPipe, NobodyWaitsForWhoDoesNotRead) {
  constexpr std::size_t kMost = 100'000;
  const std::string line(1000, 'x');
  Console console(ends_[1], kMost);
  const std::int64_t begin = steady_clock();
  for (int i = 0; i < 1000; ++i) console.print(line);  // ten times what pipe and console hold
  EXPECT_LT(steady_clock() - begin, 2'000'000);
  EXPECT_GT(console.dropped(), 500);
  while (console.dropped() > 0) {  // the reader is back
    ASSERT_TRUE(read_some());
    const std::int64_t before = console.dropped();
    console.print("again");
    if (console.dropped() == before) break;
  }
  while (!got_.ends_with("again\n")) ASSERT_TRUE(read_some());
  std::int64_t said = 0;
  for (std::size_t at = 0; (at = got_.find('(', at)) != std::string::npos; ++at)
    said += std::stoll(got_.substr(at + 1));
  EXPECT_EQ(said, console.dropped());
  EXPECT_TRUE(got_.ends_with(" lines were not printed here)\nagain\n"));
}

TEST_F(OnAPipe, ItEndsThoughNobodyReads) {
  const std::int64_t begin = steady_clock();
  {
    Console console(ends_[1]);
    console.print(std::string(500'000, 'x'));
  }
  EXPECT_LT(steady_clock() - begin, 5'000'000);
  ends_[1] = -1;  // the thread that was left behind still writes into it
}

}  // namespace
}  // namespace curbstone::procman::output
