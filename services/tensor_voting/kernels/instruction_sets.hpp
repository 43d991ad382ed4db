#pragma once

#include <vector>

namespace curbstone::tensor_voting::kernels {

#ifdef __x86_64__
/// Of three builds of one kernel those that this machine can run, the fastest first.
template <class Kernel>
std::vector<Kernel> usable(const Kernel* avx512, const Kernel* avx2, const Kernel* baseline) {
  std::vector<Kernel> kernels;
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512bw")) {
    kernels.push_back(*avx512);
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) kernels.push_back(*avx2);
  kernels.push_back(*baseline);
  return kernels;
}
#endif

}  // namespace curbstone::tensor_voting::kernels
