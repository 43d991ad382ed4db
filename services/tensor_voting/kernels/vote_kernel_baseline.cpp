#define CURBSTONE_KERNEL kVoteKernel_baseline
#define CURBSTONE_KERNEL_NAME "baseline"
#include "services/tensor_voting/kernels/vote_kernel_impl.hpp"
