#include "services/tensor_voting/kernels/vote_kernel.hpp"

#include "services/tensor_voting/kernels/instruction_sets.hpp"

namespace curbstone::tensor_voting::kernels {

extern const VoteKernel kVoteKernel_baseline;
#ifdef __x86_64__
extern const VoteKernel kVoteKernel_avx2;
extern const VoteKernel kVoteKernel_avx512;
#endif

std::span<const VoteKernel> vote_kernels() {
#ifdef __x86_64__
  static const auto kernels = usable(&kVoteKernel_avx512, &kVoteKernel_avx2, &kVoteKernel_baseline);
#else
  static const std::vector<VoteKernel> kernels{kVoteKernel_baseline};
#endif
  return kernels;
}

}  // namespace curbstone::tensor_voting::kernels
