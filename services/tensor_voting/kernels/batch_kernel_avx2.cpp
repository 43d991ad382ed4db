#define CURBSTONE_KERNEL kBatchKernel_avx2
#define CURBSTONE_KERNEL_NAME "avx2"
#include "services/tensor_voting/kernels/batch_kernel_impl.hpp"
