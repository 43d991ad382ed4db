#define CURBSTONE_KERNEL kVoteKernel_avx2
#define CURBSTONE_KERNEL_NAME "avx2"
#include "services/tensor_voting/kernels/vote_kernel_impl.hpp"
