#pragma once

#include <string>

namespace curbstone::bench::voting {

/// What this machine's arithmetic can do at most in single precision, measured: fused multiply-adds of registers only,
/// in twelve independent chains, with the widest vectors that it or the named instruction set has, on all threads at
/// once.
struct FmaPeak {
  double flops_per_s = 0;  ///< an FMA is two
  std::string isa;         ///< "avx512", "avx2", "neon", or "baseline": multiplications and additions
};
/// Takes about `seconds`; the best of ten stretches, so that a moment of somebody else's work does not make us look
/// good.
[[nodiscard]] FmaPeak measure_fma_peak(int threads, double seconds = 0.5, const std::string& isa = "");

}  // namespace curbstone::bench::voting
