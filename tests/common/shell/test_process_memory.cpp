#include "common/shell/process_memory.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace curbstone {
namespace {

constexpr std::int64_t kMB = 1'000'000;

/// Blocks of 20 kB, all of them in use.
std::vector<std::unique_ptr<std::vector<char>>> blocks(std::int64_t bytes) {
  constexpr std::int64_t kBlock = 20'000;
  std::vector<std::unique_ptr<std::vector<char>>> result;
  for (std::int64_t i = 0; i < bytes / kBlock; ++i)
    result.push_back(std::make_unique<std::vector<char>>(static_cast<std::size_t>(kBlock), 'x'));
  return result;
}

class ProcessMemoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
#ifdef CURBSTONE_SANITIZED
    GTEST_SKIP() << "memory is the sanitizer's, not the C library's";
#endif
  }
};

TEST_F(ProcessMemoryTest, WhatWasFreedBetweenBlocksInUseIsGivenBack) {
  const std::int64_t before = process_memory().own;
  auto used = blocks(200 * kMB);
  ASSERT_GT(process_memory().own, before + 190 * kMB);
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (i % 10 != 0) used[i].reset();
  }
  ASSERT_GT(process_memory().own, before + 150 * kMB) << "the C library has kept it";
  const std::int64_t returned = return_unused_memory();
  EXPECT_GT(returned, 100 * kMB);
  EXPECT_LT(process_memory().own, before + 80 * kMB);
  for (std::size_t i = 0; i < used.size(); i += 10) EXPECT_EQ(used[i]->back(), 'x');
  EXPECT_EQ(return_unused_memory(), 0) << "nothing is left to give back";
}

TEST_F(ProcessMemoryTest, LittleIsKeptForWhatComesNext) {
  (void)return_unused_memory();
  auto used = blocks(10 * kMB);
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (i % 10 != 0) used[i].reset();
  }
  EXPECT_EQ(return_unused_memory(), 0);
}

}  // namespace
}  // namespace curbstone
