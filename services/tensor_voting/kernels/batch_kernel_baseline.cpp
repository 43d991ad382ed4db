#define CURBSTONE_KERNEL kBatchKernel_baseline
#define CURBSTONE_KERNEL_NAME "baseline"
#include "services/tensor_voting/kernels/batch_kernel_impl.hpp"
