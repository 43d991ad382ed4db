#include "services/tensor_voting/vote_kernel.hpp"

#include <vector>

namespace curbstone {

extern const VoteKernel kVoteKernel_baseline;
#ifdef __x86_64__
extern const VoteKernel kVoteKernel_avx2;
extern const VoteKernel kVoteKernel_avx512;
#endif

std::span<const VoteKernel> vote_kernels() {
  static const std::vector<VoteKernel> kernels = [] {
    std::vector<VoteKernel> usable;
#ifdef __x86_64__
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512bw")) {
      usable.push_back(kVoteKernel_avx512);
    }
    if (__builtin_cpu_supports("avx2")) usable.push_back(kVoteKernel_avx2);
#endif
    usable.push_back(kVoteKernel_baseline);
    return usable;
  }();
  return kernels;
}

}  // namespace curbstone
