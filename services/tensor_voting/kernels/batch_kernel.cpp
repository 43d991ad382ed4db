#include "services/tensor_voting/kernels/batch_kernel.hpp"

#include "services/tensor_voting/kernels/instruction_sets.hpp"

namespace curbstone::tensor_voting::kernels {

extern const BatchKernel kBatchKernel_baseline;
#ifdef __x86_64__
extern const BatchKernel kBatchKernel_avx2;
extern const BatchKernel kBatchKernel_avx512;
#endif

std::span<const BatchKernel> batch_kernels() {
#ifdef __x86_64__
  static const auto kernels = usable(&kBatchKernel_avx512, &kBatchKernel_avx2, &kBatchKernel_baseline);
#else
  static const std::vector<BatchKernel> kernels{kBatchKernel_baseline};
#endif
  return kernels;
}

}  // namespace curbstone::tensor_voting::kernels
