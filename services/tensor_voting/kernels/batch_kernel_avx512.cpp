#define CURBSTONE_KERNEL kBatchKernel_avx512
#define CURBSTONE_KERNEL_NAME "avx512"
#include "services/tensor_voting/kernels/batch_kernel_impl.hpp"
