#define CURBSTONE_KERNEL kVoteKernel_avx512
#define CURBSTONE_KERNEL_NAME "avx512"
#include "services/tensor_voting/kernels/vote_kernel_impl.hpp"
