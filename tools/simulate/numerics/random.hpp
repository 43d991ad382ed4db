#pragma once

#include <cmath>
#include <cstdint>

namespace curbstone::simulate::numerics {

/// splitmix64's finaliser: mixes the bits of any 64-bit number. Counter-based noise is hash(seed, index): it depends
/// neither on the order of the draws nor on a standard library's distributions.
[[nodiscard]] constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// 0 <= u < 1 from the upper bits.
[[nodiscard]] constexpr double unit_from_bits(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * (1.0 / 9007199254740992.0);
}

/// Approximately normal, mean 0, deviation 1, never beyond 3.5: the sum of four 16-bit uniforms (Irwin-Hall). Fast.
[[nodiscard]] constexpr float normal_from_bits(std::uint64_t bits) {
  const auto sum =
      static_cast<float>((bits & 0xffff) + ((bits >> 16) & 0xffff) + ((bits >> 32) & 0xffff) + (bits >> 48));
  return (sum - 131070.0F) * (1.7320508F / 65536.0F);
}

/// A stream of reproducible random numbers, identical on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(mix_bits(seed)) {}
  /// A separate stream for a named purpose, so that an additional draw in one stream does not change another.
  [[nodiscard]] Random fork(std::uint64_t purpose) const { return Random(mix_bits(state_ ^ mix_bits(purpose))); }

  std::uint64_t bits() { return mix_bits(state_ += 0x9e3779b97f4a7c15ULL); }
  double uniform(double from = 0.0, double to = 1.0) { return from + (to - from) * unit_from_bits(bits()); }
  int integer(int from, int to) {  ///< inclusive
    return from + static_cast<int>(bits() % static_cast<std::uint64_t>(to - from + 1));
  }
  bool chance(double probability) { return uniform() < probability; }
  double normal(double sigma = 1.0) {  // Box-Muller
    const double u = 1.0 - uniform();
    return sigma * std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586 * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace curbstone::simulate::numerics
