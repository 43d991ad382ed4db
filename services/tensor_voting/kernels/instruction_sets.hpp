#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace curbstone::tensor_voting::kernels {

#ifdef __x86_64__
/// Of three builds of one kernel, those that this machine can run, fastest first.
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

/// The build for the named instruction set, "avx2" for example; the fastest if the name is empty. Throws
/// std::invalid_argument if this machine cannot run it.
template <class Kernel>
const Kernel& kernel_for(std::span<const Kernel> kernels, const std::string& name) {
  std::string names;
  for (const Kernel& kernel : kernels) {
    if (name.empty() || name == kernel.name) return kernel;
    names += std::string(" ") + kernel.name;
  }
  throw std::invalid_argument("kernel = " + name + ": this machine runs" + names);
}

}  // namespace curbstone::tensor_voting::kernels
