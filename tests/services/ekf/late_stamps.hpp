#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace curbstone::ekf {

/// Each stamp up to `most` s late, as a busy host makes them, and none before the one before it.
template <class Sample>
void make_late(std::vector<Sample>& samples, double most, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> late(0.0, most * 1e6);
  std::int64_t last = 0;
  for (Sample& sample : samples) {
    sample.utime = std::max<std::int64_t>(sample.utime + std::llround(late(random)), last + 100);
    last = sample.utime;
  }
}

}  // namespace curbstone::ekf
