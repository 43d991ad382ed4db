#include "common/parallel/parallel_for.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace curbstone {
namespace {

TEST(ParallelForTest, EachIndexIsWorkedOnOnceWhateverTheThreadsAndPieces) {
  for (const std::size_t count : {0U, 1U, 7U, 64U, 1000U}) {
    for (const std::size_t chunk : {1U, 7U, 64U, 2000U}) {
      for (const int threads : {1, 2, 5}) {
        std::vector<int> visits(count, 0);
        parallel_for(count, chunk, threads, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) ++visits[i];
        });
        EXPECT_EQ(visits, std::vector<int>(count, 1)) << count << " by " << chunk << " on " << threads;
      }
    }
  }
}

TEST(ParallelForTest, NoPieceIsLongerThanAskedFor) {
  std::vector<std::size_t> lengths;
  parallel_for(10, 4, 1, [&](std::size_t begin, std::size_t end) { lengths.push_back(end - begin); });
  EXPECT_EQ(lengths, (std::vector<std::size_t>{4, 4, 2}));
}

}  // namespace
}  // namespace curbstone
