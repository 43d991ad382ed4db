#pragma once

#include <string>

namespace curbstone::bench::voting {

/// The measured single-precision peak of this machine: fused multiply-adds on registers only, in twelve independent
/// chains, with the widest vectors available or those of the named instruction set, on all threads at once.
struct FmaPeak {
  double flops_per_s = 0;  ///< an FMA counts as two
  std::string isa;         ///< "avx512", "avx2", "neon", or "baseline": separate multiplications and additions
};
/// Takes about `seconds`. Returns the best of ten stretches: other load must not lower the peak, which would flatter
/// our figures.
[[nodiscard]] FmaPeak measure_fma_peak(int threads, double seconds = 0.5, const std::string& isa = "");

}  // namespace curbstone::bench::voting
