#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

/// @file
/// Device code is written once, in headers that g++ also compiles, so that the same source is tested on machines
/// without a GPU. nvcc compiles it with -fmad=false: only operations marked as fused (fused()) are fused, and float
/// arithmetic has the same bits on both sides, except for approximate_exp2() and approximate_quotient().
#ifdef __CUDACC__
#define CURBSTONE_HD __host__ __device__
#else
#define CURBSTONE_HD
#endif

namespace curbstone::tensor_voting::cuda {

/// a b + c, rounded once.
CURBSTONE_HD inline float fused(float a, float b, float c) {
  return ::fmaf(a, b, c);
}

/// 2^x for x <= 0 to 2^-22; results below the normal floats are 0 on the device.
CURBSTONE_HD inline float approximate_exp2(float x) {
#ifdef __CUDA_ARCH__
  float y;
  asm("ex2.approx.ftz.f32 %0, %1;" : "=f"(y) : "f"(x));
  return y;
#else
  return ::exp2f(x);
#endif
}

/// a / b to 2 units in the last place, for 2^-126 < b < 2^126.
CURBSTONE_HD inline float approximate_quotient(float a, float b) {
#ifdef __CUDA_ARCH__
  float inverse;
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(b));
  return a * inverse;
#else
  return a / b;
#endif
}

/// The nearest whole number, halves to even; |a| < 2^31.
CURBSTONE_HD inline std::int32_t rounded(float a) {
#ifdef __CUDA_ARCH__
  return __float2int_rn(a);
#else
  return static_cast<std::int32_t>(::lrintf(a));
#endif
}

CURBSTONE_HD inline float float_of_bits(std::int32_t bits) {
#ifdef __CUDA_ARCH__
  return __int_as_float(bits);
#else
  return std::bit_cast<float>(bits);
#endif
}
CURBSTONE_HD inline std::int32_t bits_of_float(float a) {
#ifdef __CUDA_ARCH__
  return __float_as_int(a);
#else
  return std::bit_cast<std::int32_t>(a);
#endif
}

template <class T>
CURBSTONE_HD T smaller(T a, T b) {
  return b < a ? b : a;
}
template <class T>
CURBSTONE_HD T larger(T a, T b) {
  return a < b ? b : a;
}

/// The first of the sorted `keys` in [begin, end) that is not below `key`; end if there is none.
CURBSTONE_HD inline std::uint32_t lower_bound(const std::uint64_t* keys, std::uint32_t begin, std::uint32_t end,
                                              std::uint64_t key) {
  while (begin < end) {
    const std::uint32_t middle = begin + (end - begin) / 2;
    if (keys[middle] < key) {
      begin = middle + 1;
    } else {
      end = middle;
    }
  }
  return begin;
}

}  // namespace curbstone::tensor_voting::cuda
