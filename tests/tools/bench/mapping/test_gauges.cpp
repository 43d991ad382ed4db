#include "tools/bench/mapping/gauges.hpp"

#include <gtest/gtest.h>

#include <list>
#include <thread>
#include <vector>

namespace curbstone::bench::mapping {
namespace {

TEST(Gauges, HeapCountsWhatAnyThreadTookAndGaveBack) {
  const double before = heap_mb();
  if (before == 0) GTEST_SKIP() << "no glibc";
  std::list<std::vector<char>> small;
  std::vector<char> large;
  std::thread([&] {
    for (int i = 0; i < 20'000; ++i) small.emplace_back(1'000);
    large.resize(30'000'000);
  }).join();
  EXPECT_NEAR(heap_mb() - before, 50, 5) << "20 MB in pieces, 30 MB in one";
  std::thread([&] { small.clear(); }).join();
  EXPECT_NEAR(heap_mb() - before, 30, 5);
}

}  // namespace
}  // namespace curbstone::bench::mapping
