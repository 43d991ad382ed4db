#include "tools/bench/voting/fma_peak.hpp"

#include <algorithm>
#include <barrier>
#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

#ifdef __x86_64__
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace curbstone::bench::voting {

namespace {

constexpr int kChains = 12;  // latency 4 times 2 units is 8; the others hide the loop overhead

/// Runs `rounds` times kChains operations on registers; returns something that depends on all of them.
using Loop = float (*)(std::int64_t rounds);
struct Machine {
  const char* isa;
  int flops;  // per operation
  Loop loop;
};

#ifdef __x86_64__
__attribute__((target("avx512f"))) float loop_avx512(std::int64_t rounds) {
  __m512 chain[kChains];
  for (int i = 0; i < kChains; ++i) chain[i] = _mm512_set1_ps(static_cast<float>(i));
  const __m512 a = _mm512_set1_ps(0.999F);
  const __m512 b = _mm512_set1_ps(0.001F);
  for (std::int64_t r = 0; r < rounds; ++r) {
#pragma GCC unroll 12
    for (int i = 0; i < kChains; ++i) chain[i] = _mm512_fmadd_ps(chain[i], a, b);
  }
  for (int i = 1; i < kChains; ++i) chain[0] = _mm512_add_ps(chain[0], chain[i]);
  return _mm512_cvtss_f32(chain[0]);
}

__attribute__((target("avx2,fma"))) float loop_avx2(std::int64_t rounds) {
  __m256 chain[kChains];
  for (int i = 0; i < kChains; ++i) chain[i] = _mm256_set1_ps(static_cast<float>(i));
  const __m256 a = _mm256_set1_ps(0.999F);
  const __m256 b = _mm256_set1_ps(0.001F);
  for (std::int64_t r = 0; r < rounds; ++r) {
#pragma GCC unroll 12
    for (int i = 0; i < kChains; ++i) chain[i] = _mm256_fmadd_ps(chain[i], a, b);
  }
  for (int i = 1; i < kChains; ++i) chain[0] = _mm256_add_ps(chain[0], chain[i]);
  return _mm256_cvtss_f32(chain[0]);
}
#endif

#ifdef __aarch64__
float loop_neon(std::int64_t rounds) {
  float32x4_t chain[kChains];
  for (int i = 0; i < kChains; ++i) chain[i] = vdupq_n_f32(static_cast<float>(i));
  const float32x4_t a = vdupq_n_f32(0.999F);
  const float32x4_t b = vdupq_n_f32(0.001F);
  for (std::int64_t r = 0; r < rounds; ++r) {
#pragma GCC unroll 12
    for (int i = 0; i < kChains; ++i) chain[i] = vfmaq_f32(b, chain[i], a);
  }
  for (int i = 1; i < kChains; ++i) chain[0] = vaddq_f32(chain[0], chain[i]);
  return vgetq_lane_f32(chain[0], 0);
}
#endif

/// Four lanes, multiplication then addition: for any machine.
float loop_baseline(std::int64_t rounds) {
  using Four [[gnu::vector_size(16)]] = float;
  Four chain[kChains];
  for (int i = 0; i < kChains; ++i) chain[i] = Four{} + static_cast<float>(i);
  for (std::int64_t r = 0; r < rounds; ++r) {
#pragma GCC unroll 12
    for (int i = 0; i < kChains; ++i) chain[i] = chain[i] * 0.999F + 0.001F;
  }
  for (int i = 1; i < kChains; ++i) chain[0] += chain[i];
  return chain[0][0];
}

/// The widest instruction set, or the one of that name.
Machine this_machine(const std::string& isa) {
  const auto wanted = [&](const char* name) { return isa.empty() || isa == name; };
#ifdef __x86_64__
  __builtin_cpu_init();
  if (wanted("avx512") && __builtin_cpu_supports("avx512f")) return {"avx512", 32, loop_avx512};
  if (wanted("avx2") && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return {"avx2", 16, loop_avx2};
#elif defined(__aarch64__)
  if (wanted("neon") || isa == "baseline") return {"neon", 8, loop_neon};
#endif
  return {"baseline", 8, loop_baseline};
}

/// s for `rounds` on every thread, from when all are ready until the last one is done.
double time_all(const Machine& machine, int threads, std::int64_t rounds) {
  using Clock = std::chrono::steady_clock;
  std::barrier ready(threads);
  std::vector<Clock::time_point> begin(static_cast<std::size_t>(threads)), end(begin.size());
  volatile float sink = 0;
  const auto work = [&](std::size_t t) {
    ready.arrive_and_wait();
    begin[t] = Clock::now();
    const float value = machine.loop(rounds);
    end[t] = Clock::now();
    if (value == 12345.0F) sink = value;  // never true; keeps the loop
  };
  {
    std::vector<std::jthread> helpers;
    for (std::size_t t = 1; t < begin.size(); ++t) helpers.emplace_back(work, t);
    work(0);
  }
  const auto first = *std::min_element(begin.begin(), begin.end());
  const auto last = *std::max_element(end.begin(), end.end());
  return std::chrono::duration<double>(last - first).count();
}

}  // namespace

FmaPeak measure_fma_peak(int threads, double seconds, const std::string& isa) {
  constexpr int kStretches = 10;
  const Machine machine = this_machine(isa);
  std::int64_t rounds = 1 << 20;
  const double trial = time_all(machine, threads, rounds);
  rounds = std::max<std::int64_t>(
      1000, static_cast<std::int64_t>(static_cast<double>(rounds) * seconds / kStretches / trial));
  FmaPeak peak{0, machine.isa};
  for (int i = 0; i < kStretches; ++i) {
    const double took = time_all(machine, threads, rounds);
    const double flops = static_cast<double>(rounds) * kChains * machine.flops * threads;
    peak.flops_per_s = std::max(peak.flops_per_s, flops / took);
  }
  return peak;
}

}  // namespace curbstone::bench::voting
