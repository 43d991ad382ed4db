#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace curbstone {

/// Calls work(begin, end) for pieces of [0, count) of at most `chunk`, on `threads` threads, including the calling one.
/// `work` must not throw. The result of a piece must not depend on other pieces; the total result is then independent
/// of the number of threads.
template <class Work>
void parallel_for(std::size_t count, std::size_t chunk, int threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto run = [&] {
    for (std::size_t begin = next.fetch_add(chunk); begin < count; begin = next.fetch_add(chunk)) {
      work(begin, begin + chunk < count ? begin + chunk : count);
    }
  };
  std::vector<std::jthread> helpers;
  for (int t = 1; t < threads && static_cast<std::size_t>(t) * chunk < count; ++t) helpers.emplace_back(run);
  run();
}

}  // namespace curbstone
