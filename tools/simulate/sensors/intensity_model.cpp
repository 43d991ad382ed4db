#include "tools/simulate/sensors/intensity_model.hpp"

#include <algorithm>
#include <cmath>

#include "tools/simulate/numerics/random.hpp"

namespace curbstone::simulate::sensors {

namespace {

constexpr double kAsphalt = 0.14;      // reflectivity
constexpr double kUsual = 0.15;        // cosine of incidence on a road, about 10 m away
constexpr double kGrain = 0.10;        // 1 sigma, of the power: speckle
constexpr double kReadOut = 1.2;       // of 255, 1 sigma
constexpr std::uint64_t kDevice = 64;  // seed of the device whose lasers have these scales

struct LaserScale {
  double gain = 64;  ///< of 255, for asphalt
  double offset = 0;
  double zeros = 0;  ///< share of the returns
};

LaserScale scale_of(int laser) {
  numerics::Random random = numerics::Random(kDevice).fork(static_cast<std::uint64_t>(laser));
  // Multiples of irrational numbers fill the ranges evenly for any number of lasers.
  const auto share = [&](double turn) { return turn * laser - std::floor(turn * laser); };
  const double median = 10.0 + 77.0 * share(0.6180339887498949), dim = share(0.7548776662466927);
  const double offset = random.uniform(-0.15, 0.25) * median;
  return {median - offset, offset, 0.03 + 0.37 * dim * dim};
}

}  // namespace

std::uint8_t IntensityModel::report(const world::Hit& hit, float reflectivity, int laser, std::uint64_t noise) const {
  const LaserScale scale = ring_gains ? scale_of(laser) : LaserScale{};
  const std::uint64_t dice = numerics::mix_bits(noise ^ 0x1117ULL);
  if (numerics::unit_from_bits(numerics::mix_bits(dice)) < scale.zeros) return 0;
  const double power = std::pow(static_cast<double>(reflectivity) / kAsphalt, 0.9) *
                       std::pow(static_cast<double>(std::max(hit.incidence, 0.02F)) / kUsual, 0.3) *
                       std::pow(10.0 / static_cast<double>(std::max(hit.range, 1.0F)), 0.1);
  const double grain = 1.0 + kGrain * static_cast<double>(numerics::normal_from_bits(numerics::mix_bits(dice + 1)));
  const double read_out = kReadOut * static_cast<double>(numerics::normal_from_bits(numerics::mix_bits(dice + 2)));
  const double value = std::clamp(scale.offset + scale.gain * power * grain + read_out, 0.0, 255.0);
  return static_cast<std::uint8_t>(std::min(255.0, step * std::round(value / step)));
}

}  // namespace curbstone::simulate::sensors
