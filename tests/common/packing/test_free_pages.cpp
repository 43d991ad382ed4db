#include "common/packing/free_pages.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <vector>

namespace curbstone {
namespace {

TEST(FreePages, GrowTheFileOnlyWhenNoGapIsLongEnough) {
  FreePages pages;
  EXPECT_EQ(pages.take(3), 0U);
  EXPECT_EQ(pages.take(2), 3U);
  EXPECT_EQ(pages.take(1), 5U);
  pages.release(0, 3);
  EXPECT_EQ(pages.take(4), 6U);
  EXPECT_EQ(pages.take(2), 0U);
  EXPECT_EQ(pages.take(1), 2U);
  EXPECT_EQ(pages.num_pages(), 10U);
}

TEST(FreePages, GapsThatTouchAreOne) {
  FreePages pages;
  for (int i = 0; i < 5; ++i) (void)pages.take(2);
  pages.release(2, 2);
  pages.release(6, 2);
  pages.release(4, 2);
  EXPECT_EQ(pages.take(6), 2U);
}

TEST(FreePages, TheLastOnesAreCutOff) {
  FreePages pages;
  for (int i = 0; i < 3; ++i) (void)pages.take(2);
  pages.release(2, 2);
  pages.release(4, 2);
  EXPECT_EQ(pages.num_pages(), 2U);
  pages.release(0, 2);
  EXPECT_EQ(pages.num_pages(), 0U);
}

TEST(FreePages, ArePromisedToOneAtATime) {
  std::mt19937 random(3);
  FreePages pages;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> taken;
  std::set<std::uint64_t> used;
  for (int i = 0; i < 5000; ++i) {
    if (taken.empty() || random() % 100 < 55) {
      const std::uint64_t count = 1 + random() % 20;
      const std::uint64_t first = pages.take(count);
      for (std::uint64_t page = first; page < first + count; ++page) ASSERT_TRUE(used.insert(page).second);
      taken.emplace_back(first, count);
    } else {
      std::swap(taken[random() % taken.size()], taken.back());
      const auto [first, count] = taken.back();
      taken.pop_back();
      for (std::uint64_t page = first; page < first + count; ++page) used.erase(page);
      pages.release(first, count);
    }
    ASSERT_LE(used.empty() ? 0 : *used.rbegin() + 1, pages.num_pages());
  }
  EXPECT_LT(pages.num_pages(), 2 * used.size());
}

}  // namespace
}  // namespace curbstone
