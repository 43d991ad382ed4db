// Vectors as wide as the instruction set for which a kernel's source is compiled. For kernel sources only: everything
// is in an unnamed namespace, so that a copy compiled for one machine cannot be linked into code for another.
#pragma once

#if defined(__x86_64__)
#include <immintrin.h>
#else
#include <cmath>
#endif

#include <cstdint>

#define CURBSTONE_INLINE __attribute__((always_inline)) inline

namespace curbstone::tensor_voting::kernels {
namespace {

#if defined(__AVX512F__)
constexpr int kWidth = 16;
#elif defined(__AVX2__)
constexpr int kWidth = 8;
#else
constexpr int kWidth = 4;
#endif

using Floats = float __attribute__((vector_size(4 * kWidth)));
using Ints = std::int32_t __attribute__((vector_size(4 * kWidth)));
using Shorts = std::int16_t __attribute__((vector_size(2 * kWidth)));
using Words = std::uint32_t __attribute__((vector_size(4 * kWidth)));
using HalfInts = std::int32_t __attribute__((vector_size(2 * kWidth)));
using HalfFloats = float __attribute__((vector_size(2 * kWidth)));
using Longs = std::int64_t __attribute__((vector_size(4 * kWidth)));  // half of the lanes

#if defined(__AVX512F__)
using Mask = __mmask16;
#else
using Mask = Ints;  // -1 or 0
#endif

template <class Vector>
CURBSTONE_INLINE Vector load(const void* from) {
  Vector v;
  __builtin_memcpy(&v, from, sizeof v);
  return v;
}
template <class Vector>
CURBSTONE_INLINE void store(void* to, const Vector& v) {
  __builtin_memcpy(to, &v, sizeof v);
}

CURBSTONE_INLINE Floats all(float v) {
  return v - Floats{};  // v + 0 would change -0 to +0
}

/// Differences of coordinates, which may wrap.
CURBSTONE_INLINE Floats difference(Ints a, std::int32_t b) {
  const Words d = __builtin_bit_cast(Words, a) - static_cast<std::uint32_t>(b);
  return __builtin_convertvector(__builtin_bit_cast(Ints, d), Floats);
}

CURBSTONE_INLINE Mask below(Floats a, Floats b) {
#if defined(__AVX512F__)
  return _mm512_cmp_ps_mask(__builtin_bit_cast(__m512, a), __builtin_bit_cast(__m512, b), _CMP_LT_OQ);
#else
  return a < b;
#endif
}
/// a < b in the lanes of `mask`.
CURBSTONE_INLINE Mask below(Mask mask, Floats a, Floats b) {
#if defined(__AVX512F__)
  return _mm512_mask_cmp_ps_mask(mask, __builtin_bit_cast(__m512, a), __builtin_bit_cast(__m512, b), _CMP_LT_OQ);
#else
  return mask & (a < b);
#endif
}
/// low <= a < high; none of them is below 0. The order of such floats is the order of their bits: one comparison
/// suffices.
CURBSTONE_INLINE Mask between(float low, Floats a, float high) {
  constexpr std::uint32_t kLowest = 1U << 31;
  const std::uint32_t from_low = kLowest - __builtin_bit_cast(std::uint32_t, low);  // values below wrap to the top
  const Ints bits = __builtin_bit_cast(Ints, __builtin_bit_cast(Words, a) + from_low);
  const Ints limit = Ints{} + static_cast<std::int32_t>(__builtin_bit_cast(std::uint32_t, high) + from_low);
#if defined(__AVX512F__)
  return _mm512_cmplt_epi32_mask(__builtin_bit_cast(__m512i, bits), __builtin_bit_cast(__m512i, limit));
#else
  return bits < limit;
#endif
}
/// `a` where the mask is set, `b` elsewhere.
CURBSTONE_INLINE Floats choose(Mask mask, Floats a, Floats b) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(Floats,
                            _mm512_mask_blend_ps(mask, __builtin_bit_cast(__m512, b), __builtin_bit_cast(__m512, a)));
#else
  return mask ? a : b;
#endif
}
/// `a` where the mask is set, zero elsewhere.
CURBSTONE_INLINE Floats keep(Mask mask, Floats a) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(Floats, _mm512_maskz_mov_ps(mask, __builtin_bit_cast(__m512, a)));
#else
  return __builtin_bit_cast(Floats, __builtin_bit_cast(Ints, a) & mask);
#endif
}

/// One bit for each lane.
CURBSTONE_INLINE unsigned bits(Mask mask) {
#if defined(__AVX512F__)
  return mask;
#elif defined(__AVX2__)
  return static_cast<unsigned>(_mm256_movemask_ps(__builtin_bit_cast(__m256, mask)));
#elif defined(__x86_64__)
  return static_cast<unsigned>(_mm_movemask_ps(__builtin_bit_cast(__m128, mask)));
#else
  unsigned result = 0;
  for (int lane = 0; lane < kWidth; ++lane) result |= (mask[lane] & 1U) << lane;
  return result;
#endif
}

/// The correctly rounded square root.
CURBSTONE_INLINE Floats root(Floats a) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(Floats, _mm512_sqrt_ps(__builtin_bit_cast(__m512, a)));
#elif defined(__AVX2__)
  return __builtin_bit_cast(Floats, _mm256_sqrt_ps(__builtin_bit_cast(__m256, a)));
#elif defined(__x86_64__)
  return __builtin_bit_cast(Floats, _mm_sqrt_ps(__builtin_bit_cast(__m128, a)));
#else
  for (int lane = 0; lane < kWidth; ++lane) a[lane] = std::sqrt(a[lane]);
  return a;
#endif
}

/// Rounds to the nearest integer, halves to even; |a| < 2^31.
CURBSTONE_INLINE Ints rounded(Floats a) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(Ints, _mm512_cvtps_epi32(__builtin_bit_cast(__m512, a)));
#elif defined(__AVX2__)
  return __builtin_bit_cast(Ints, _mm256_cvtps_epi32(__builtin_bit_cast(__m256, a)));
#elif defined(__x86_64__)
  return __builtin_bit_cast(Ints, _mm_cvtps_epi32(__builtin_bit_cast(__m128, a)));
#else
  Ints result;
  for (int lane = 0; lane < kWidth; ++lane) result[lane] = static_cast<std::int32_t>(std::nearbyint(a[lane]));
  return result;
#endif
}

#if defined(__AVX2__) && !defined(__AVX512F__)
/// For each set of lanes: the indices of its lanes, packed.
struct PackedLanes {
  std::uint8_t lane[256][8] = {};
  constexpr PackedLanes() {
    for (unsigned set = 0; set < 256; ++set) {
      unsigned size = 0;
      for (std::uint8_t i = 0; i < 8; ++i) {
        if ((set >> i & 1U) != 0) lane[set][size++] = i;
      }
    }
  }
};
constexpr PackedLanes kPackedLanes;
#endif

/// Writes the lanes of the mask contiguously; up to kWidth elements at `to` may be overwritten.
template <class Vector>
CURBSTONE_INLINE void store_packed(void* to, Mask mask, const Vector& v) {
#if defined(__AVX512F__)
  _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(mask, __builtin_bit_cast(__m512i, v)));
#elif defined(__AVX2__)
  const __m256i lanes = _mm256_cvtepu8_epi32(
      _mm_loadl_epi64(static_cast<const __m128i*>(static_cast<const void*>(kPackedLanes.lane[bits(mask)]))));
  store(to, _mm256_permutevar8x32_epi32(__builtin_bit_cast(__m256i, v), lanes));
#else
  std::uint32_t lanes[kWidth];
  __builtin_memcpy(lanes, &v, sizeof lanes);
  auto* out = static_cast<unsigned char*>(to);
  for (unsigned rest = bits(mask); rest != 0; rest &= rest - 1, out += 4) {
    __builtin_memcpy(out, &lanes[__builtin_ctz(rest)], 4);
  }
#endif
}

}  // namespace
}  // namespace curbstone::tensor_voting::kernels
